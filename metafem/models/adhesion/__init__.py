"""Adhesive contacts followed along their branches, with jumps."""
