"""Figures and pages; the only part that draws."""

from metafem.report.cautions import cautions
from metafem.report.page import page, parameter_rows, wanted

__all__ = ["cautions", "page", "parameter_rows", "wanted"]
