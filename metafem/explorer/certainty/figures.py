"""Key figures for the reliability of a design, each with its bound and a remedy.

Reports and studies compute these numbers with the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from metafem._values import percent, three_digits
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty import band
from metafem.inversion import Design
from metafem.inversion.assessment import DesignStatus
from metafem.inversion.feasibility import ELASTIC_LIMIT
from metafem.models.model import contact_of
from metafem.models.model_error import reference_of
from metafem.models.truncation import COMPARED, crowding
from metafem.prediction.validity import (
    BOUND,
    TOO_WIDE,
    WIDEST,
    base_contact_load,
)
from metafem.report import fit_table, misfit_words
from metafem.studies.largest_tolerances import ALLOWED
from metafem.studies.sampling.slope import Slope
from metafem.substrate import HalfSpace


class Standing(StrEnum):
    """Rating of a number against its bound; the value is the word that the page shows."""

    GOOD = "good"
    WARNING = "warning"
    REMARK = "remark"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Figure:
    """One number that shows how reliable the design is.

    Attributes
    ----------
    name, value, bound : str
        Name of the number, its value with its unit, and the bound with which it is compared.
    standing : Standing
    sentence : str
        Meaning of the number, and a remedy if there is one.
    places : tuple of str
        Where the page shows a warning: "law", "surface", or keys of the specification.
    """

    name: str
    value: str
    bound: str
    standing: Standing
    sentence: str
    places: tuple[str, ...] = ()

    @property
    def warns(self) -> bool:
        """Whether the number is rated as a warning."""
        return self.standing is Standing.WARNING


def figures(answer: Answer) -> tuple[Figure, ...]:
    """Return the key numbers for the surface in an answer; an empty tuple without a surface."""
    design = answer.design
    if design is None:
        return ()
    parts: tuple[tuple[str, Callable[[], list[Figure]]], ...] = (
        ("misfit", lambda: [_misfit(design)]),
        ("fitted slopes", lambda: _slopes(design)),
        ("estimated error of the model", lambda: [_model_error(design)]),
        ("scatter of made surfaces", lambda: _scatter(answer, design)),
        ("load at which the plane touches the base", lambda: [_base(design)]),
        ("largest contacts", lambda: _widths(design)),
        ("plasticity index", lambda: _plasticity(design)),
    )
    found: list[Figure] = []
    for name, part in parts:
        try:
            found += part()
        except MetafemError as error:
            found.append(Figure(name, "unknown", "", Standing.UNKNOWN, _sentence(str(error))))
    return tuple(found)


def _misfit(design: Design) -> Figure:
    name, value = misfit_words(design)
    missed = design.status is DesignStatus.MISSED
    remedy = " Move the target towards the achieved law, or widen the limits." if missed else ""
    bound = design.largest_misfit
    return Figure(
        name, value, f"at most {percent(bound, '.3g')}", _judged(not missed),
        _sentence(design.status.value) + remedy, ("law",),
    )  # fmt: skip


def _slopes(design: Design) -> list[Figure]:
    columns, rows = fit_table(design)
    name, (loads, unit) = design.target.wording.name(), columns[0].rstrip("]").split(" [")
    bound = design.largest_misfit
    found = []
    for (branch, fit), row in zip(design.fits, rows, strict=True):
        near = abs(fit.slope / branch.slope - 1.0) <= bound
        remedy = "" if near else " Give target.load_range, widen the limits, or change the target."
        found.append(
            Figure(
                f"fitted {name}, {loads} {row[0]} {unit}", row[2], f"target {row[1]}", _judged(near),
                f"It differs from the target by {row[3]}; up to {percent(bound, '.3g')} counts as reached."
                + remedy,
                ("law",),
            )
        )  # fmt: skip
    return found


def _model_error(design: Design) -> Figure:
    """Return the figure for the estimated error of the law by its model."""
    name, error, model = "estimated error of the model", design.law.model_error, design.law.model
    if math.isnan(error):
        return Figure(name, "unknown", "", Standing.UNKNOWN, _sentence(error.source))
    words, remedy, places = f"Estimated by {error.source}.", "", ("law", "model.kind", "lattice.pitch")
    size, value = float(error), percent(error)
    substrate = "half-space" if reference_of(design.surface, model).substrate == HalfSpace() else "layer"
    if not model.couples and error.load.size:
        most, size = int(np.abs(error.change).argmax()), math.sqrt(float((error.change**2).mean()))
        value = f"{percent(size)} rms"
        way = "lowers" if error.change[most] < 0.0 else "raises"
        newtons = design.surface.material.composite_modulus * error.load[most]
        words = (
            f"Elastic interaction on the {substrate}, which this design leaves out, {way} the friction at a "
            f"given load by up to {percent(abs(error.change[most]))}, at {three_digits(newtons)} N."
        )
        remedy = f" Use the model {substrate}, or a larger pitch."
    good = size <= BOUND
    bound = f"at most {percent(BOUND, 'g')}"
    return Figure(name, value, bound, _judged(good), words + remedy * (not good), places)


def _scatter(answer: Answer, design: Design) -> list[Figure]:
    """Return the key numbers for the scatter of the law and of its slope among manufactured surfaces."""
    name, tolerances = "scatter of the law of made surfaces", band.tolerances_of(answer)
    if tolerances is None:
        words = 'State the errors of the part, for example limits.height_sd = "0.9 um".'
        return [Figure(name, "not stated", "", Standing.REMARK, words, ("limits.height_sd",))]
    bound, errors = f"at most {percent(ALLOWED, 'g')}", band.tolerance_words(tolerances)
    key = "robust" if tolerances == design.robust else "limits.height_sd"
    places, finer = ("law", key), " Make the part more exactly, or use more asperities."

    def judged(name: str, sd: float, words: str) -> Figure:
        within = sd <= ALLOWED
        return Figure(
            name, f"{percent(sd)} SD", bound, _judged(within), words + ("" if within else finer), places
        )

    drawn, linear = band.drawn_of(answer), band.linear(answer)
    found = []
    if drawn is not None:
        rms = math.sqrt(float(((drawn.sd / drawn.mean) ** 2).mean()))
        error = percent(1.0 / math.sqrt(2.0 * drawn.count), ".1g")
        words = f"Of {drawn.count} drawn surfaces with {errors}, rms over the loads; sampling error {error}."
        found.append(judged(name, rms, words))
    elif linear is not None:
        _, area, sd = linear
        words = f"By linear response to {errors}, rms over the loads. Draws follow when nothing changes."
        found.append(judged(name, math.sqrt(float(((sd / area) ** 2).mean())), words))
    if linear is None:
        words = "It is not computed at once for so many asperities; draw surfaces below."
        return found or [Figure(name, "unknown", "", Standing.UNKNOWN, words)]
    if np.ptp(design.surface.height) == 0.0:  # with equal heights a slope has no default load range
        return found
    fit = Slope.of(design.surface, None, design.law.model)
    response = design.law.model.gradient_model.sensitivity(design.surface, fit.load)
    slope = fit.weight @ response.curve.checked().rescaled_friction
    sd = band.deviations(tolerances, design.surface, (fit.weight @ response.gradient)[None])[0]
    ends = design.surface.material.composite_modulus * np.array(fit.load_range)
    low, high = map(three_digits, ends)
    words = f"By linear response to {errors}; fitted from {low} to {high} N, as in studies."
    return [*found, judged("scatter of the slope of made surfaces", float(sd / abs(slope)), words)]


def _base(design: Design) -> Figure:
    """Return the figure for the load at which the plane touches the base between the summits."""
    modulus, last = design.surface.material.composite_modulus, design.law.load[-1]
    onset = modulus * base_contact_load(design.surface, design.law.model)
    free = onset > last
    words = "The plane stays clear of the base up to the largest load." if free else (
        "Beyond this load the base carries a part that the law does not count: raise limits.offset, or use "
        "lighter loads."
    )  # fmt: skip
    return Figure(
        "load at which the plane touches the base", f"{three_digits(onset)} N",
        f"largest load {three_digits(last)} N",
        _judged(free), words, ("surface", "limits.offset"),
    )  # fmt: skip


def _widths(design: Design) -> list[Figure]:
    """Return the figures for the contact radius at the largest load.

    The radius is compared with the radius of curvature and with the distance to the neighbouring contact.
    """
    surface, law = design.surface, contact_of(design.law.model)
    model = design.law.model.gradient_model
    area = model.curve(surface, design.law.rescaled_load[-1:]).checked().last.area
    wide = float((np.sqrt(area / math.pi) / surface.radius).max())
    overlaps, near = crowding(surface, area, law)
    newtons = f"at {three_digits(design.law.load[-1])} N"
    # `near` is 0 if no pair is close enough to be evaluated
    ratio = f"{near:.2f}" if near else f"below {COMPARED:g}"
    words = f"Small strain holds up to about {WIDEST:g}, with a fitted modulus."
    remedy = " Use lighter loads, more asperities or larger radii."
    far = f" Order 3 of the interaction was compared with resolved contacts up to {COMPARED:g}."
    merged = f" {overlaps} pairs overlap, where real contacts merge: use a larger pitch or lighter loads."
    return [
        Figure(
            "widest contact, a/R", f"{wide:.2f} {newtons}", f"at most {WIDEST:g}",
            _judged(wide <= WIDEST, wide <= TOO_WIDE), words + remedy * (wide > WIDEST),
            ("surface", "lattice.radius"),
        ),
        Figure(
            "contact radius over the distance to its neighbour", f"{ratio} {newtons}",
            f"at most {COMPARED:g}", _judged(near <= COMPARED, not overlaps),
            "Contacts that are far apart stay separate." + far * (near > COMPARED) + merged * (overlaps > 0),
            ("surface", "lattice.pitch"),
        ),
    ]  # fmt: skip


def _plasticity(design: Design) -> list[Figure]:
    """Return the figure for the plasticity index; an empty list if the specification has no hardness."""
    index = design.parameters.get("plasticity_index")
    if index is None:
        return []
    psi = float(np.asarray(index))
    elastic = psi < ELASTIC_LIMIT
    remedy = "" if elastic else " Use larger radii, closer heights or a material with a smaller E*/H."
    return [
        Figure(
            "plasticity index", f"{psi:.2g}", f"below {ELASTIC_LIMIT:g}", _judged(elastic),
            f"Contacts of a surface with a smaller index stay elastic.{remedy}",
            ("surface", "checks.hardness"),
        )
    ]  # fmt: skip


def _judged(good: bool, tolerable: bool = False) -> Standing:
    return Standing.GOOD if good else Standing.REMARK if tolerable else Standing.WARNING


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:].rstrip(".") + "."
