"""Quantities besides friction, printed by `metafem predict --quantities`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import metafem as mf
from metafem.cli.terminal import print_table, say, terminal

if TYPE_CHECKING:
    from metafem import FrictionLaw, Surface
    from metafem._validate import FloatArray
    from metafem.models import Model


def quantities_of(surface: Surface, model: Model, law: FrictionLaw) -> dict[str, FloatArray]:
    """Return the quantities of a law besides friction, by name with unit."""
    conducts = mf.conductance(surface, model, load=law.load, resistivity=1.0)
    return {
        "stiffness [N/mm]": law.stiffness,
        "tangential stiffness [N/mm]": mf.tangential_stiffness(surface, model, load=law.load),
        "rescaled conductance [mm]": conducts.rescaled_conductance,
    }


def columns_of(shown: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return quantities by the names of columns: ``tangential_stiffness_N_per_mm``."""
    return {
        title.replace(" [", "_").rstrip("]").replace("/", "_per_").replace(" ", "_"): values
        for title, values in shown.items()
    }


def print_quantities(law: FrictionLaw, shown: Mapping[str, FloatArray], whole: bool) -> None:
    """Print quantities of a law, at all loads if `whole` is true, otherwise at about ten."""
    console, step = terminal(), 1 if whole else max(1, len(law.load) // 10)
    rows = [
        [f"{law.load[i]:.6g}", *(f"{values[i]:.6g}" for values in shown.values())]
        for i in range(step - 1, len(law.load), step)
    ]
    print_table(console, ["load [N]", *shown], rows)
    say(console, f"model {law.model.name}")
