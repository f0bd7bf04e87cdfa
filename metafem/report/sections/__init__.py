"""Sections of the report that are made of the studies of a design."""
