"""Encoder, servo, load and the pieces that a tape measures."""
