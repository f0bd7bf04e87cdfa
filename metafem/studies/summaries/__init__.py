"""Tables and sentences that summarise studies."""

from metafem.studies.summaries.table import Summary
from metafem.studies.summaries.tables import summary

__all__ = ["Summary", "summary"]
