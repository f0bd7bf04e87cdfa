"""Searches for heights whose law is nearest to a target law."""
