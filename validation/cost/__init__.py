"""Seconds and errors of each law, and how the seconds grow with the number of asperities."""
