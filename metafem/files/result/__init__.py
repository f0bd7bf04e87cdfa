"""The result folder of a design, written and read."""
