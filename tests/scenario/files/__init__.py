"""Files of scenarios and of recorded lines."""
