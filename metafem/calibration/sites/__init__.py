"""Matching of the contacts in images to the sites of a design."""
