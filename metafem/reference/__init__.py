"""Closed forms with which results are compared; no solver uses them."""
