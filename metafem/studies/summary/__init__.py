"""Tables and sentences that summarise studies."""

from metafem.studies.summary.table import Summary
from metafem.studies.summary.tables import summary

__all__ = ["Summary", "summary"]
