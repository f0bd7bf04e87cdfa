"""Where an interacting model leaves its range, said in the notes of a state."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.notes import Note
from metafem.substrate import BondedLayer, Substrate
from metafem.surface import Surface

# Contact radius over distance of neighbours up to which order 3 was compared with resolved contacts.
COMPARED = 0.32

# Contact radius over radius of curvature up to which Hertz's law with a fitted modulus stays near the soft
# cap at large strain: 2 % at .5, and a tenth of grace.
WIDEST = 0.55


def wide_notes(surface: Surface, contact_radius: FloatArray, load: float) -> tuple[Note, ...]:
    """Say where contacts are wider than any model of small strain holds for; the load in N."""
    ratio = float((contact_radius / surface.radius).max())
    if ratio <= WIDEST:
        return ()
    return (
        Note(
            f"the widest contact has a/R = {ratio:.2f} at {load:.4g} N: Hertz's law "
            f"holds up to about {WIDEST:g}, with a fitted modulus"
        ),
    )


def refuse_thin_layer(substrate: Substrate, contact_radius: float) -> None:
    """Raise InvalidInput where contacts are wider than the layer is thick: no expansion holds there."""
    thickness = substrate.thickness if isinstance(substrate, BondedLayer) else None
    if thickness is not None and contact_radius > thickness:
        raise InvalidInput(
            f"the layer of {thickness:g} mm is thinner than the contacts, whose radius is "
            f"{contact_radius:.4g} mm; use resolved contacts or a thicker layer"
        )


def interaction_notes(
    surface: Surface, contact_radius: FloatArray, indentation: FloatArray
) -> tuple[Note, ...]:
    """Return what a reader of the state must know: overlap, wide contacts, the base plane."""
    from scipy.spatial import cKDTree

    notes: list[Note] = []
    closed = np.flatnonzero(contact_radius > 0.0)
    if closed.size > 1:
        a = contact_radius[closed]
        # the field of j bends i by p_j R_i/r^3, (a_j/r)^3 R_i/R_j: a sharp summit counts as a wider one
        blunt = np.cbrt(surface.radius[closed])
        sharp = a / blunt
        # pairs beyond this cannot overlap, nor leave the range
        reach = float((sharp * blunt.max()).max()) * max(2.0, 1.0 / COMPARED)
        tree = cKDTree(surface.position[closed])
        i, j = tree.query_pairs(reach, output_type="ndarray").T
        if i.size:
            r = np.hypot(*(tree.data[i] - tree.data[j]).T)
            overlaps = int((a[i] + a[j] > r).sum())
            bending = np.maximum(sharp[j] * blunt[i], sharp[i] * blunt[j])
            ratio = float((np.maximum(np.maximum(a[i], a[j]), bending) / r).max())
            if overlaps:
                notes.append(
                    Note(
                        f"contacts overlap: {overlaps} pairs of them reach into each other; resolved "
                        "contacts would merge"
                    )
                )
            elif ratio > COMPARED:
                notes.append(
                    Note(
                        f"a/r = {ratio:.2f} exceeds {COMPARED}, up to which order 3 was compared with "
                        "resolved contacts"
                    )
                )
    # the base under a contact has come nearer to the plane by its displacement: h - d is left
    left = float((surface.height - indentation).min())
    if left <= 0.0:
        notes.append(
            Note(
                f"the base plane would touch: {left:.4g} mm are left beside an asperity; "
                "the load it would carry is not counted"
            )
        )
    return tuple(notes)
