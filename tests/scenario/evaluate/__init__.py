"""What is made of the course of a run."""
