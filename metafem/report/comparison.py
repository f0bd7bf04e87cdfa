"""Comparison of the law of one surface under several models."""

from __future__ import annotations

from dataclasses import dataclass

from metafem._validate import FloatArray
from metafem.inversion import Design
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.prediction import FrictionLaw
from metafem.report.names import model_words
from metafem.studies.substrates import laws_on_substrates

# Largest number of asperities for which interacting laws are compared: a report then takes a second or two.
MOST_COMPARED = 1500


@dataclass(frozen=True, eq=False)
class Comparison:
    """A law and its difference from that of independent asperities at the same loads."""

    name: str
    law: FrictionLaw
    difference: FloatArray  # (k,), relative difference of A0 [-]
    sinking: FloatArray  # (k,), decrease of the separation [mm]


def compared(design: Design) -> tuple[tuple[Comparison, ...], tuple[Note, ...]]:
    """Predict a design's law under the common models, at the loads of the design's law.

    The models are the half-space, with a block also the bonded layer and the true block, and the model of the
    design's law if it is a different one. Surfaces of more than 1,500 asperities are not compared. The true
    block is included only if its influence has been computed before. The notes state which models are left
    out.
    """
    if design.surface.count > MOST_COMPARED:
        return (), ()
    predicted, notes = laws_on_substrates(
        design.surface, design.law.load, contact_of(design.law.model), wait=False
    )
    independent = predicted["independent"]
    laws = {law.model.name: law for law in predicted.values() if law.model.couples}
    # the law of the design may be under one of these models
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
