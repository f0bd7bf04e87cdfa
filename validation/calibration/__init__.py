"""Calibration, images, measured laws and surfaces, diagnosis."""
