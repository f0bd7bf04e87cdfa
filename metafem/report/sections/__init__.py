"""Sections of the report on the studies of a design."""
