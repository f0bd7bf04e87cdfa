"""Files of the design, and the command that gives the same result."""
