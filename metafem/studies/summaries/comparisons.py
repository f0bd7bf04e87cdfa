"""Tables of the comparisons between models and between assignments of heights to sites."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES
from metafem.notes import information
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# Loads of the columns, as fractions of the largest load.
SHOWN_LOADS = (0.1, 0.4, 1.0)

# Meaning of the last columns of the table of interaction.
RANDOM = (
    "random: the asperities assigned to the sites at random, at every fifth load; centred: the tallest in "
    "the centre; rms: root mean square change of A0 over the loads"
)


def fidelity_summary(study: Dataset) -> Summary:
    """Return how each model changes A0 and the separation."""
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
    return Summary(title, columns, tuple(rows), stored_notes(study))


def interaction_summary(study: Dataset) -> Summary:
    """Return how coupling changes A0, for the design and for other assignments of heights to sites."""
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
    title = f"Change of A0 by interaction; decrease of the separation at {float(study['load'][-1]):.3g} N"
    return Summary(title, columns, tuple(rows), (information(RANDOM), *stored_notes(study)))


def _rms(change: FloatArray) -> float:
    return float(np.sqrt((change**2).mean()))


def _largest(change: FloatArray) -> float:
    return float(change[np.abs(change).argmax()])
