"""Random scenes and trials that tests and benchmarks share, and the table of the models."""
