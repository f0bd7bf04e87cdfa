"""Designs whose contacts stay elastic if possible, according to the plasticity index."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from metafem import _validate as check
from metafem.contact import KogutEtsion
from metafem.errors import Infeasible
from metafem.inversion.assessment import DesignStatus
from metafem.inversion.design import design
from metafem.inversion.feasibility import ELASTIC_LIMIT, INDEX, roughness
from metafem.inversion.result import Design
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import Message
from metafem.inversion.tools.kit import Given, chosen, default_contact, singles
from metafem.models import Independent, Model
from metafem.models.model import contact_of, with_contact
from metafem.notes import Note, information, when_read
from metafem.surface import Surface


def design_for_hardness(
    target: Target,
    template: Surface,
    hardness: float,
    model: Model | None = None,
    *,
    tools: Given | None = None,
    common_radius: bool = False,
    **others: Any,
) -> Design:
    """Return a design with elastic contacts if its plasticity index allows, otherwise with plastic contacts.

    The plasticity index of the designed surface is ``psi = E*/H sqrt(s/R)``, where s is the standard
    deviation of its heights and R the mean radius. The function returns the first of these designs that
    exists:

    1. The design under the elastic law of the model, if psi < 0.6.
    2. A design with one of the `tools` for all asperities, if psi < 0.6 and the target is reached. If there
       are several, it is the design with the smallest misfit.
    3. The design under `KogutEtsion(hardness)`, whose interaction is of order 1. Its note states the ratio
       E*/H below which the contacts would stay elastic.

    Parameters
    ----------
    hardness : float
        H of the softer material [MPa], positive.
    target, template, model, tools, common_radius
        As in `design`. If the contact law of the model is plastic, it remains in use.
    others
        Further arguments of `design`: limits, rng, layout and robust.

    Returns
    -------
    Design
        Its parameters also include ``plasticity_index`` [-] and, unless all heights are equal,
        ``largest_modulus_ratio`` [-], the E*/H at which the plasticity index of this surface would be 0.6.
        Its first note states which of the three designs it is.

    Raises
    ------
    Infeasible
        As in `design`; also if only elastic contacts could reach the target, but they would become plastic.
    InvalidInput
        For arguments outside their range or of the wrong kind.

    Notes
    -----
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242; Aymard et al.,
    Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> found = design_for_hardness(mf.LinearLaw(6.87), template, hardness=10.0)
    >>> print(found.notes[0])
    the contacts stay elastic: the plasticity index is 0.0316, below 0.6, with H = 10 MPa
    """
    h = check.number("hardness", hardness, above=0.0)
    solver = Independent(default_contact(tools)) if model is None else model

    def under(surface: Surface, model: Model, **options: Any) -> Design:
        return design(target, surface, model, **others, **options)

    def index(found: Design) -> float:
        return template.material.composite_modulus / h * roughness(found.surface)

    first = under(template, solver, tools=tools, common_radius=common_radius)
    psi = index(first)
    given = f"with H = {h:g} MPa"
    if contact_of(solver).bound(template).plastic:
        return _noted(first, h, information(f"the contacts are those of {contact_of(solver)!r}"))
    if psi < ELASTIC_LIMIT:
        text = f"the contacts stay elastic: the plasticity index is {psi:.3g}, below {ELASTIC_LIMIT}, {given}"
        return _noted(first, h, information(text))
    reached = [first]
    for alone in () if tools is None else singles(*chosen(tools, template)):
        try:
            one = under(alone, solver)
        except Infeasible:
            continue
        if one.status is not DesignStatus.MISSED:
            reached.append(one)
    why = f"the plasticity index {psi:.3g} is not below {ELASTIC_LIMIT} {given}"
    if elastic := [one for one in reached if index(one) < ELASTIC_LIMIT]:
        best = min(elastic, key=lambda one: one.misfit)
        text = (
            f"{why}; with the radius {float(best.surface.radius[0]):g} mm for all asperities it is "
            f"{index(best):.3g}, and the contacts stay elastic"
        )
        return _noted(best, h, information(text))
    least = ELASTIC_LIMIT / min(roughness(one.surface) for one in reached)
    besides = "" if tools is None else ", nor with any of the tools"
    law = KogutEtsion(h)
    why += f"{besides}; a material with E*/H below {least:.3g} would stay elastic"
    try:
        plastic = under(template, with_contact(solver, law), tools=tools, common_radius=common_radius)
    except Infeasible as error:
        message = Message((f"{why}, and under {law!r} no surface is found: ", error.message))
        raise Infeasible(message, error.nearest, error.by_search) from None
    text = (
        f"{why}; this design is for the law {law!r} of plastic contacts: the first loading flattens the "
        "summits, and later ones differ (friction_law with unloading=True)"
    )
    note = Note(text, quantity=INDEX, value=psi, bound=ELASTIC_LIMIT, remedies=("hardness", "radius"))
    return _noted(plastic, h, note)


def _noted(found: Design, hardness: float, note: Note) -> Design:
    """Return a design with its plasticity index among the parameters, and with a note before the others."""
    rough = roughness(found.surface)
    index = found.surface.material.composite_modulus / hardness * rough
    parameters = {**found.parameters, "plasticity_index": index}
    if rough > 0.0:
        parameters["largest_modulus_ratio"] = ELASTIC_LIMIT / rough
    later = when_read(lambda: (note, *found.notes), size=found.surface.count)
    return replace(found, parameters=parameters, notes=later)
