"""The surface: heights as a map and in three dimensions."""
