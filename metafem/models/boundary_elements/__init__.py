"""Resolved contacts: the pressure on cells of a grid."""
