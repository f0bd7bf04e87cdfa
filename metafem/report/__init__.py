"""Report pages and their figures."""

from metafem.report.fits import fit_table
from metafem.report.names import all_notes, misfit_words, model_data
from metafem.report.page import page, parameter_rows

__all__ = ["all_notes", "fit_table", "misfit_words", "model_data", "page", "parameter_rows"]
