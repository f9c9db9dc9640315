"""Commands that describe, build and write, and the command line itself."""
