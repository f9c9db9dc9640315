"""A block that is a package, for tests: they copy it into a copy of the model."""
