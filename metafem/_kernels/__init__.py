"""Compiled kernels; each has a readable numpy twin in tests/."""
