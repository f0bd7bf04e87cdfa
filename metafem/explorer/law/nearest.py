"""The nearest law that can be designed, written as the target of a specification."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.law.kinds import points
from metafem.explorer.law.shown import Units
from metafem.explorer.text.document import Document
from metafem.explorer.text.handles import handles, moved
from metafem.explorer.text.written import stated
from metafem.inversion import OperatingPoints, SampledLaw

# Relative resolution of the values: the nearest law is inside its bound by a millionth.
RESOLUTION = 1e-9


def with_nearest(answer: Answer) -> str:
    """Return the text of a refused answer with the nearest law that can be designed as its target."""
    target, specification, text = answer.nearest_target, answer.specification, answer.state.text
    if target is None or specification is None:
        raise InvalidInput("no nearest law is known")
    if isinstance(target, (OperatingPoints, SampledLaw)):
        return _with_points(answer, target)
    for place in handles(text, replace(specification, target=target), answer.design):
        now = specification_of(replace(answer.state, text=text))
        at = place.load, place.friction
        text = moved(text, now, answer.design, place.id, *at, resolution=RESOLUTION)
    return text


def _with_points(answer: Answer, target: OperatingPoints | SampledLaw) -> str:
    """Return the text with other points, in the units of those before."""
    assert answer.specification is not None
    template, section = answer.specification.template, Document(answer.state.text).value("target")
    stress = None
    if template.friction is not None:
        stress = template.friction.shear_strength * template.friction.area_ratio
    forces = "load" in section
    loads, frictions = ("load", "friction_force") if forces else ("rescaled_load", "rescaled_friction")
    values: dict[str, Any]
    if len(section.get(loads, ())) == len(target.rescaled_load):
        modulus = template.material.composite_modulus
        columns = ((loads, target.rescaled_load, modulus), (frictions, target.rescaled_friction, stress))
        values = {
            name: [
                stated(float(value), like, factor, RESOLUTION)
                for value, like in zip(column, section[name], strict=True)
            ]
            for name, column, factor in columns
        }
    else:  # the points of a table
        digits = round(1 - np.log10(RESOLUTION))
        values = {"file": None, **points(target.rescaled_load, target.rescaled_friction, Units(), digits)}
    document = Document(answer.state.text)
    return document.with_values({f"target.{name}": value for name, value in values.items()})
