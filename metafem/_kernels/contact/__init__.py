"""Compiled versions of the contact laws in `metafem.contact`."""
