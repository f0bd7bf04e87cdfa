"""Measured friction laws: error bars, branches, crossover and agreement with a design."""
