"""The law of one surface on substrates of increasing detail."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.errors import InvalidInput, NotConverged
from metafem.models import Independent, Interacting, Model
from metafem.notes import Note, information
from metafem.prediction import FrictionLaw, friction_law
from metafem.progress import each
from metafem.substrate import BondedLayer
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.fe import Block3D


def laws_on_substrates(
    surface: Surface, load: FloatArray, contact: Contact, *, wait: bool
) -> tuple[dict[str, FrictionLaw], list[Note]]:
    """Return the law of independent asperities, the laws on three substrates, and notes.

    The substrates are the half-space, the bonded layer and the true block. All models have the contact law
    `contact` with its largest order of interaction. The keys are the names of the models on the command line,
    "independent" first. load: (k,) [N]. The notes state which models are left out and why: the layer and the
    true block if the surface has no block, the true block if its influence is not on disk and `wait` is
    False, and models without a solution.
    """
    order = contact.largest_order
    models: dict[str, Model] = {
        "independent": Independent(contact=contact),
        "half-space": Interacting(order=order, contact=contact),
    }
    notes: list[Note] = []
    if surface.block is None:
        notes.append(information("the layer and the true block are left out: the surface has no block"))
    else:
        models["layer"] = Interacting(order=order, substrate=BondedLayer(), contact=contact)
        block, reason = _true_block(surface, wait)
        if block is None:
            notes.append(information(reason))
        else:
            models["block"] = Interacting(order=order, substrate=block, contact=contact)
    laws = {}
    for name in each("law", list(models)):
        try:
            laws[name] = friction_law(surface, models[name], load=load)
        except (InvalidInput, NotConverged) as reason:
            if not models[name].couples:
                raise
            notes.append(
                information(
                    f"the {name} is left out: order {order} has no solution up to {load[-1]:.4g} N ({reason})"
                )
            )
    return laws, notes


def _true_block(surface: Surface, wait: bool) -> tuple[Block3D | None, str]:
    """Return the substrate of the true block and an empty text, or None and the reason for leaving it out."""
    from metafem.fe import Block3D  # imports scikit-fem; no other model needs it

    substrate = Block3D()
    try:
        kept = substrate.is_kept(surface)
    except InvalidInput as error:
        return None, f"the true block is left out: {error}"
    if not (kept or wait):
        return None, (
            "the true block is left out: its influence between these sites has not been computed. This takes "
            "about a minute; `metafem study fidelity` computes and stores it"
        )
    return substrate, ""
