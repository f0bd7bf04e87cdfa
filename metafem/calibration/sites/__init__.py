"""Matching of contacts in images to the sites of a design."""
