"""The files of the block in CONTRIBUTING's example; a test runs them in a copy of the project."""

collect_ignore_glob = ["*"]
