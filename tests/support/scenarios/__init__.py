"""Scenarios, their files, runs and references."""
