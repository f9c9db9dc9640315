"""The motion of an axis: laws, jerk-limited motions, their limits, and what exceeds them."""
