"""What a design is worth: its law by better models, and what its making and its use change; as datasets."""

from metafem.studies.fidelity import fidelity
from metafem.studies.interaction import interaction
from metafem.studies.summary import Summary, summary

__all__ = ["Summary", "fidelity", "interaction", "summary"]
