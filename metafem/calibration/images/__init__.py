"""Measurement of contact areas in images of the contact interface."""
