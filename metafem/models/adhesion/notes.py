"""Checks of adhesive contacts, and notes on their jumps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.contact import JKR, Contact
from metafem.contact.adhesion import of_sizes
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.models.neighbours import close_pairs
from metafem.notes import Note, information
from metafem.surface import Surface


class Jump(NamedTuple):
    """A jump of the contact area at a load."""

    load: float  # [mm^2]
    before: float  # area before the jump [mm^2]
    after: float  # area after the jump [mm^2]


def adhesive_law(contact: Contact, material: Material | None = None) -> JKR | None:
    """Return the law for a material if it is adhesive, otherwise None."""
    law = contact if material is None else contact.for_material(material)
    if not law.adhesive:
        return None
    if not isinstance(law, JKR):
        raise InvalidInput(
            f"contact = {shown(law)}: the branches of adhesive laws other than metafem.JKR are unknown"
        )
    return law


def refuse_merging(law: JKR, surface: Surface) -> None:
    """Raise InvalidInput if neighbouring contacts would merge at zero load."""
    reach = of_sizes(JKR.zero_load_radius, law, law.summits(surface))
    first, second, distance = close_pairs(surface.position, surface.cell, 2.0 * float(reach.max()))
    if not first.size:
        return
    room = distance - reach[first] - reach[second]
    if room.min() <= 0.0:
        i, j = sorted((first[room.argmin()], second[room.argmin()]))
        raise InvalidInput(
            f"adhesion_energy = {law.adhesion_energy:g} N/mm: the contacts of asperities {i} and {j} would "
            f"merge without load, with radii of {reach[i]:.3g} and {reach[j]:.3g} mm at a distance of "
            f"{distance[room.argmin()]:.3g} mm; use a smaller energy, a larger modulus or a larger pitch"
        )


def jump_notes(jumps: list[Jump], modulus: float, unloading: bool) -> tuple[Note, ...]:
    """Return a note on the number, the loads and the sizes of the jumps of a curve, or none."""
    if not jumps:
        return ()
    newtons = modulus * np.array([jump.load for jump in jumps])
    change = np.array([jump.after - jump.before for jump in jumps])
    most = int(np.abs(change).argmax())
    span = f"at {newtons[0]:.4g} N"
    if len(jumps) > 1:
        span = f"from {newtons.min():.4g} to {newtons.max():.4g} N"
    what = "break on unloading" if unloading else "jump into contact on loading"
    count = "1 jump" if len(jumps) == 1 else f"{len(jumps)} jumps"
    return (
        information(
            f"{count} of A0, {span}, where asperities {what}; the largest changes A0 by "
            f"{change[most]:+.3g} mm^2, at {newtons[most]:.4g} N"
        ),
    )


def refuse_beyond(load: float, pull_off: float, modulus: float) -> None:
    """Raise InvalidInput for a load beyond the pull-off load; both loads are rescaled [mm^2]."""
    raise InvalidInput(
        f"load = {modulus * load:.6g} N is beyond pull-off: on unloading the last contacts break at "
        f"{modulus * pull_off:.6g} N; use loads from there on"
    )


def refuse_no_loading(values: FloatArray, by_load: bool, least: float) -> None:
    """Raise InvalidInput if there is no contact at the largest load or approach, where unloading begins."""
    if values[-1] <= least:
        what = "load" if by_load else "approach"
        raise InvalidInput(
            f"the largest {what} is {values[-1]:g}; unloading begins at the largest {what}, which must be "
            f"greater than {least:g}"
        )
