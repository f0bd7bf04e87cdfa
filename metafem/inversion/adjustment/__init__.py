"""Adjustment of the heights of an inversion to another model, to tolerances and to height steps."""
