"""The law of one surface under several models."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion import Design
from metafem.law import FrictionLaw, friction_law
from metafem.models import Independent, Interacting, Model
from metafem.substrate import BondedLayer

# A page is drawn in a second or two; beyond this number of asperities interacting laws take longer.
MOST_COMPARED = 1500


@dataclass(frozen=True, eq=False)
class Comparison:
    """A law and how far it is from that of independent asperities, at the same loads.

    Attributes
    ----------
    name : str
    law : FrictionLaw
    difference : ndarray, (k,)
        Relative difference of A0 [-].
    sinking : ndarray, (k,)
        How much nearer the plane stands to the undeformed base plane [mm].
    """

    name: str
    law: FrictionLaw
    difference: FloatArray
    sinking: FloatArray


def compared(design: Design) -> tuple[Comparison, ...]:
    """Predict a design's law under the common models, at the loads of its own law.

    The half-space, the bonded layer where there is a block, and the model of the design's law if it is
    another one; nothing for surfaces of more than 1,500 asperities.
    """
    if design.surface.count > MOST_COMPARED:
        return ()
    models: dict[str, Model] = {"half-space": Interacting()}
    if design.surface.block is not None:
        models["bonded layer"] = Interacting(substrate=BondedLayer())
    load = design.law.load
    independent = friction_law(design.surface, Independent(), load=load)
    laws = {name: friction_law(design.surface, model, load=load) for name, model in models.items()}
    if design.law.model not in (Independent(), *models.values()):
        laws[repr(design.law.model)] = design.law
    return tuple(
        Comparison(
            name,
            law,
            np.asarray(law.area / independent.area - 1.0),
            independent.separation - law.separation,
        )
        for name, law in laws.items()
    )
