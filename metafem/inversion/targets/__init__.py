"""Wanted friction laws."""
