"""Sheared contacts: area ratio, shear strength, records of shear tests, fully contacting surfaces."""
