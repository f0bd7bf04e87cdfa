"""Resolved contacts: pressures on the cells of a grid."""
