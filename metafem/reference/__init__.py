"""Closed-form solutions for comparison with computed results; no solver uses them."""
