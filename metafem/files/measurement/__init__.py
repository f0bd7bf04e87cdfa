"""Measured tables, images and height maps, read with their units."""
