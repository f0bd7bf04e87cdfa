"""Asperities coupled through an elastic substrate."""
