"""Heights of an inversion, adjusted to another model, to tolerances and to height steps."""
