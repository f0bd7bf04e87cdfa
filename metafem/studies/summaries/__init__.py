"""Tables and sentences that summarise studies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from metafem.errors import refuse_if
from metafem.studies.summaries.comparisons import fidelity_summary, interaction_summary
from metafem.studies.summaries.measurements import explained_summary, measured_summary
from metafem.studies.summaries.parameters import uncertainty_summary
from metafem.studies.summaries.table import Summary
from metafem.studies.summaries.tolerances import manufacturing_summary, misalignment_summary

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Summary", "summary"]

SUMMARIES: Mapping[str, Callable[[Dataset], Summary]] = {
    "explained": explained_summary,
    "fidelity": fidelity_summary,
    "interaction": interaction_summary,
    "manufacturing": manufacturing_summary,
    "measured": measured_summary,
    "misalignment": misalignment_summary,
    "uncertainty": uncertainty_summary,
}


def summary(study: Dataset) -> Summary:
    """Return the summary of a study: a table, notes and a sentence.

    Parameters
    ----------
    study : xarray.Dataset
        Result of a function of `metafem.studies`.

    Returns
    -------
    Summary

    Raises
    ------
    InvalidInput
        If the dataset is not the result of a study.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> summary(mf.studies.interaction(design, placements=5)).columns[:3]
    ('substrate', 'order', 'rms [%]')
    """
    name = str(study.attrs.get("study", ""))
    refuse_if(name not in SUMMARIES, f"there is no summary of a study {name!r}")
    return SUMMARIES[name](study)
