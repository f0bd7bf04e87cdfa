"""Calibration, images, measured laws and surfaces, explanations."""
