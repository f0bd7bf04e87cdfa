"""Specification files, read into the package's own types."""
