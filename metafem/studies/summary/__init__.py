"""Tables and sentences that summarise studies."""

from metafem.studies.summary.tables import Summary, summary

__all__ = ["Summary", "summary"]
