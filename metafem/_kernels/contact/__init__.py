"""Compiled twins of the laws in `metafem.contact`."""
