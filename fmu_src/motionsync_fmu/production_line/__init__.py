"""A line: the telegrams of a remote axis go through RemoteSync into a follower, in an SSP package.

The axis belongs to another controller with a clock of its own. A line file scripts that axis. So its motion is known
exactly, and the errors of the follower with RemoteSync and without it can be computed.
"""
