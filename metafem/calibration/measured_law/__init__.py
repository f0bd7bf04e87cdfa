"""Measured friction laws: their error bars, branches and crossover, and their agreement with a design."""
