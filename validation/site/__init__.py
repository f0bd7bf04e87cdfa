"""The pages of the guide, of the examples and of the programming interface."""

from __future__ import annotations

import warnings
from pathlib import Path

from metafem._extras import refuse_missing
from validation.site.examples import write_examples
from validation.site.guide import write_guide

# The modules of the reference; what stands below them is internal.
MODULES = (
    "metafem", "metafem.contact", "metafem.substrate", "metafem.models", "metafem.prediction", "metafem.fe",
    "metafem.studies", "metafem.calibration", "metafem.files", "metafem.report", "metafem.progress",
    "metafem.reference",
)  # fmt: skip


def write_site(folder: Path) -> None:
    """Write all into a folder."""
    refuse_missing("pdoc", "docs", "writing the pages of the examples and of the reference")
    write_guide(folder)
    write_examples(folder)
    write_api(folder / "api")


def write_api(folder: Path) -> None:
    """Write the reference by pdoc."""
    import pdoc
    from pdoc import render

    render.configure(docformat="numpy", show_source=False, search=False)
    with warnings.catch_warnings():  # names that stand in annotations for the type checker alone
        warnings.filterwarnings("ignore", "Error parsing type annotation", UserWarning)
        pdoc.pdoc("metafem", r"!metafem\..+", *MODULES[1:], r"!metafem\.\w+\..+", output_directory=folder)
