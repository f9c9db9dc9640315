"""What both machines that cut to length are held to."""
