"""Adhesive contacts, followed along their branches of equilibria and through jumps."""
