"""Compiled kernels; the tests compare each with a readable numpy version."""
