"""Specifications in, parts and result folders out: the border where units and file formats are known."""

from metafem.files.folder import load, save
from metafem.files.spec import Specification, read_spec

__all__ = ["Specification", "load", "read_spec", "save"]
