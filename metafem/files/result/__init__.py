"""Writing and reading of the result folder of a design."""
