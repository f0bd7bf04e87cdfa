"""Calibration of E* and the adhesion energy from compression tests."""
