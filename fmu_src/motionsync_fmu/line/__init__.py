"""A line: the telegrams of a remote axis, through RemoteSync, into a follower; wired in an SSP package and in libcosim.

Who follows sees the axis of another controller, whose clock is not its own. A line file scripts that axis; everything
about it is known exactly, so that the error of the follower with RemoteSync, and without it, can be told.
"""
