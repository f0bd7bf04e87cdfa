"""Files of the design, and the command that produces the same result."""
