"""Comparison of the law of one surface under several models."""

from __future__ import annotations

from dataclasses import dataclass

from metafem._validate import FloatArray
from metafem.inversion import Design
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.prediction import FrictionLaw
from metafem.report.names import model_words
from metafem.studies.models import laws_on_substrates

# Largest number of asperities for which interacting laws are compared. Up to this number, a report takes a
# second or two.
MOST_COMPARED = 1500


@dataclass(frozen=True, eq=False)
class Comparison:
    """A law, and its differences from the law of independent asperities at the same loads."""

    name: str
    law: FrictionLaw
    difference: FloatArray  # (k,), relative difference of A0 [-]
    sinking: FloatArray  # (k,), decrease of the separation [mm]


def compared(design: Design) -> tuple[tuple[Comparison, ...], tuple[Note, ...]]:
    """Return the laws of a design under the common models, at the loads of the design's law, and notes.

    The common models are asperities on the half-space and, with a block, on the bonded layer and the true
    block. The design's own law is added if its model is a different one. The true block is included only if
    its influence has been computed before. The notes state which models are left out. Surfaces of more than
    1,500 asperities are not compared.
    """
    if design.surface.count > MOST_COMPARED:
        return (), ()
    predicted, notes = laws_on_substrates(
        design.surface, design.law.load, contact_of(design.law.model), wait=False
    )
    independent = predicted["independent"]
    laws = {law.model.name: law for law in predicted.values() if law.model.couples}
    # add the law of the design, unless its model is one of the compared models
    if design.law.model not in (independent.model, *(law.model for law in laws.values())):
        laws[design.law.model.name] = design.law
    comparisons = tuple(
        Comparison(
            model_words(law.model),
            law,
            law.area / independent.area - 1.0,
            independent.separation - law.separation,
        )
        for law in laws.values()
    )
    return comparisons, tuple(notes)
