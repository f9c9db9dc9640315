"""A line: the telegrams of a remote axis go through RemoteSync into a follower, in an SSP package and in libcosim.

The axis belongs to another controller, which has a clock of its own. A line file scripts that axis. Its motion is
therefore known exactly, and so is the error of the follower with RemoteSync and without it.
"""
