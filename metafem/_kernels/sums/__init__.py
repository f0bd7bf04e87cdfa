"""Compiled kernels of fast sums."""
