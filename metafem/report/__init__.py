"""Figures and pages; the only part that draws."""

from metafem.report.cautions import cautions
from metafem.report.names import model_name
from metafem.report.page import page, parameter_rows, wanted

__all__ = ["cautions", "model_name", "page", "parameter_rows", "wanted"]
