"""Values that take the place of a scenario's."""
