"""Figures and pages; the only part that draws."""

from metafem.report.cautions import cautions
from metafem.report.names import misfit_words, model_name
from metafem.report.page import page, parameter_rows, wanted

__all__ = ["cautions", "misfit_words", "model_name", "page", "parameter_rows", "wanted"]
