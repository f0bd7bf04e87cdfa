"""Strategies that find heights of independent asperities for each kind of target."""
