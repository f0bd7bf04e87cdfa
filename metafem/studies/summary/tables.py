"""Tables that summarise studies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.notes import Note, from_lines, information

if TYPE_CHECKING:
    from xarray import Dataset

# Loads of the columns, as fractions of the largest load.
SHOWN_LOADS = (0.1, 0.4, 1.0)


@dataclass(frozen=True)
class Summary:
    """A table of texts that summarises a study.

    Attributes
    ----------
    title : str
    columns : tuple of str
        Headings.
    rows : tuple of tuple of str
    notes : tuple of Note

    Examples
    --------
    >>> Summary("Change of A0", ("model", "rms [%]"), (("layer", "0.21"),), ()).rows[0]
    ('layer', '0.21')
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[Note, ...]


def summary(study: Dataset) -> Summary:
    """Return the table of a study.

    Parameters
    ----------
    study : xarray.Dataset
        Result of `interaction` or `fidelity`.

    Returns
    -------
    Summary

    Raises
    ------
    InvalidInput
        For any other data set.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> summary(mf.studies.interaction(design, placements=5)).columns[:3]
    ('substrate', 'order', 'rms [%]')
    """
    name = study.attrs.get("study")
    if name not in _SUMMARIES:
        raise InvalidInput(f"there is no summary of a study {name!r}")
    title, columns, rows = _SUMMARIES[name](study)
    remarks = (information(RANDOM),) if name == "interaction" else ()
    return Summary(title, columns, rows, (*remarks, *from_lines(str(study.attrs["notes"]))))


# Meaning of the last columns of the interaction's table.
RANDOM = (
    "random: the asperities assigned to the sites at random, at every fifth load; centred: the tallest in "
    "the centre; rms: root mean square change of A0 over the loads"
)

Table = tuple[str, tuple[str, ...], tuple[tuple[str, ...], ...]]


def _fidelity(study: Dataset) -> Table:
    load = study["load"].values
    shown = [int(np.abs(load - fraction * load[-1]).argmin()) for fraction in SHOWN_LOADS]
    columns = (
        "model",
        "rms [%]",
        "largest [%]",
        *(f"at {load[i]:.3g} N [%]" for i in shown),
        "A0 [mm²]",
        "separation [µm]",
        "plane lower by [µm]",
    )
    rows = []
    for name in study.model.values:
        row = study.sel(model=name)
        change = row.area_change.values
        rows.append(
            (
                str(name),
                f"{100.0 * _rms(change):.2f}",
                f"{100.0 * _largest(change):+.2f}",
                *(f"{100.0 * change[i]:+.2f}" for i in shown),
                f"{float(row.area[-1]):.5g}",
                f"{MICROMETRES * float(row.separation[-1]):.2f}",
                f"{MICROMETRES * float(row.sinking[-1]):+.2f}",
            )
        )
    title = f"Change of A0 from independent asperities; A0 and separation at {load[-1]:.3g} N"
    return title, columns, tuple(rows)


def _interaction(study: Dataset) -> Table:
    columns = (
        "substrate",
        "order",
        "rms [%]",
        "max. [%]",
        "plane lower by [µm]",
        "random: median rms [%]",
        "max. rms [%]",
        "centred: rms [%]",
    )
    rows = []
    for substrate in study.substrate.values:
        for order in study.order.values:
            row = study.sel(substrate=substrate, order=order)
            change = row.area_change.values
            spread: tuple[str, ...] = ("",) * 3
            if order == study.order.values[-1]:
                placed = row.placement_rms.values
                shown = (float(np.median(placed)), float(placed.max()), _rms(row.centred_change.values))
                spread = tuple(f"{100.0 * value:.2f}" for value in shown)
            rows.append(
                (
                    str(substrate),
                    str(order),
                    f"{100.0 * _rms(change):.2f}",
                    f"{100.0 * _largest(change):+.2f}",
                    f"{MICROMETRES * float(row.sinking[-1]):.2f}",
                    *spread,
                )
            )
    return (
        f"Change of A0 by interaction; decrease of the separation at {float(study['load'][-1]):.3g} N",
        columns,
        tuple(rows),
    )


_SUMMARIES = {"fidelity": _fidelity, "interaction": _interaction}


def _rms(change: FloatArray) -> float:
    return float(np.sqrt((change**2).mean()))


def _largest(change: FloatArray) -> float:
    return float(change[np.abs(change).argmax()])
