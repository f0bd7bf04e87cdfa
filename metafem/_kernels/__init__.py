"""Compiled kernels; the tests compare them with readable numpy versions."""
