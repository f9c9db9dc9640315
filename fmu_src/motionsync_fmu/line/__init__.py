"""A line: the telegrams of a remote axis, through RemoteSync, into a follower; wired in an SSP package and in libcosim.

The follower sees the axis of another controller, whose clock is not its own. A line file scripts that axis. So the axis
is known exactly, and with it the error of the follower with RemoteSync and without it.
"""
