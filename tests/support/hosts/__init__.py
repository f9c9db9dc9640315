"""What runs FMUs and libraries: importers, validators, hosts in C."""
