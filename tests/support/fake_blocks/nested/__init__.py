"""A block that is a package; tests copy it into a copy of the model."""
