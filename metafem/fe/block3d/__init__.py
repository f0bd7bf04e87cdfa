"""The true block with its free sides, as a substrate."""
