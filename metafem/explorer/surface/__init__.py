"""The view of the surface: its heights as a map and as a three-dimensional picture."""
