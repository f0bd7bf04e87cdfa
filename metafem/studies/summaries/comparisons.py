"""Tables of the comparisons between models and between assignments of heights to sites."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES
from metafem.notes import information
from metafem.studies.summaries.table import Columns, Summary, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# Loads with a column of their own, as fractions of the largest load.
SHOWN_LOADS = (0.1, 0.4, 1.0)

# Meaning of the last columns of the interaction table.
RANDOM = (
    "random: the asperities assigned to the sites at random, at every fifth load; centred: the tallest in "
    "the centre; rms: root mean square change of A0 over the loads"
)


def fidelity_summary(study: Dataset) -> Summary:
    """Return the table of the changes of A0 and of the separation under each model."""
    load, change, last = study["load"].values, study["area_change"].values, study.isel(rescaled_load=-1)
    shown = [int(np.abs(load - fraction * load[-1]).argmin()) for fraction in SHOWN_LOADS]
    columns: Columns = {
        "model": study["model"].values,
        "rms [%]": texts(".2f", 100.0 * rms(change)),
        "largest [%]": texts("+.2f", 100.0 * largest(change)),
        **{f"at {load[i]:.3g} N [%]": texts("+.2f", 100.0 * change[:, i]) for i in shown},
        "A0 [mm²]": texts(".5g", last["area"].values),
        "separation [µm]": texts(".2f", MICROMETRES * last["separation"].values),
        "plane lower by [µm]": texts("+.2f", MICROMETRES * last["sinking"].values),
    }
    title = f"Change of A0 from independent asperities; A0 and separation at {load[-1]:.3g} N"
    return summarised(study, title, columns)


def interaction_summary(study: Dataset) -> Summary:
    """Return the table of the changes of A0 by coupling, also for other assignments of heights to sites."""
    change, placed = study["area_change"].values, study["placement_rms"].values
    substrates, orders, loads = change.shape
    change = change.reshape(-1, loads)

    def at_largest(values: FloatArray) -> list[str]:
        """Return a column with one text for each substrate, in the row of its largest order."""
        return [text for value in texts(".2f", 100.0 * values) for text in [""] * (orders - 1) + [value]]

    columns: Columns = {
        "substrate": np.repeat(study["substrate"].values, orders),
        "order": np.tile(study["order"].values, substrates),
        "rms [%]": texts(".2f", 100.0 * rms(change)),
        "max. [%]": texts("+.2f", 100.0 * largest(change)),
        "plane lower by [µm]": texts(".2f", MICROMETRES * study["sinking"].values[..., -1].ravel()),
        "random: median rms [%]": at_largest(np.median(placed, axis=1)),
        "max. rms [%]": at_largest(placed.max(axis=1)),
        "centred: rms [%]": at_largest(rms(study["centred_change"].values)),
    }
    title = f"Change of A0 by interaction; decrease of the separation at {float(study['load'][-1]):.3g} N"
    return summarised(study, title, columns, "", information(RANDOM))


def rms(change: FloatArray) -> FloatArray:
    """Return the root mean square over the loads, the last axis."""
    return np.asarray(np.sqrt((change**2).mean(axis=-1)))


def largest(change: FloatArray) -> FloatArray:
    """Return the change of largest magnitude over the loads, the last axis, with its sign."""
    place = np.abs(change).argmax(axis=-1, keepdims=True)
    return np.asarray(np.take_along_axis(change, place, axis=-1)[..., 0])
