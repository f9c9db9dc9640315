"""What the command line does, as functions: a module for each. `motionsync_fmu` has them by their names."""
