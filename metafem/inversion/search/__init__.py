"""Searches for heights whose law is nearest to a wanted one."""
