"""The files below are those of a block that CONTRIBUTING adds; they run where a test has copied them to."""

collect_ignore_glob = ["*"]
