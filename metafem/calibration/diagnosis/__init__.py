"""Diagnosis: the errors of a made part that explain why its measured law differs from the design."""
