"""Numbers: ranges that can be computed with, roots, and elementary functions whose bits are the same everywhere."""
