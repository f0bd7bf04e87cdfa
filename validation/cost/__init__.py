"""Seconds and errors of each law."""
