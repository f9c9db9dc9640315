"""Numbers of 50 digits, roots, and noise."""
