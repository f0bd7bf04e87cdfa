"""Figures and pages; the only part that draws."""
