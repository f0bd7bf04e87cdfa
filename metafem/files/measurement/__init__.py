"""Reading of measured tables, images and height maps with their units."""
