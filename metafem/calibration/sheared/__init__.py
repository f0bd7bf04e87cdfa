"""Shear calibration: area ratio, shear strength, records of shear tests, surfaces in full contact."""
