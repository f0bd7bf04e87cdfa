"""Key figures for the reliability of a design, each with its bound and a remedy.

Reports and studies compute these numbers with the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from metafem._values import percent, three_digits
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty import band
from metafem.inversion import Design
from metafem.inversion.assessment import DesignStatus
from metafem.inversion.feasibility import ELASTIC_LIMIT, INDEX
from metafem.models.model import contact_of
from metafem.models.model_error import reference_of
from metafem.models.truncation import COMPARED, crowding
from metafem.prediction.validity import (
    BASE,
    BOUND,
    TOO_WIDE,
    WIDEST,
    WIDTH,
    base_contact_load,
)
from metafem.report import fit_table, misfit_words
from metafem.studies.largest_tolerances import ALLOWED
from metafem.studies.sampling.slope import Slope
from metafem.studies.summaries.comparisons import rms
from metafem.substrate import HalfSpace

# What the table of two designs compares.
MISFIT, MODEL_ERROR, SCATTER = "misfit", "estimated error of the model", "scatter of made surfaces"


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
    quantity : str
        What is judged; the same for figures that differ in what they are fitted to or compared with.
    """

    name: str
    value: str
    bound: str
    standing: Standing
    sentence: str
    places: tuple[str, ...] = ()
    quantity: str = ""

    @property
    def warns(self) -> bool:
        """Whether the number is rated as a warning."""
        return self.standing is Standing.WARNING


def figures(answer: Answer) -> tuple[Figure, ...]:
    """Return the key numbers for the surface in an answer; an empty tuple without a surface."""
    design = answer.design
    if design is None:
        return ()
    parts: dict[str, Callable[[Design], list[Figure]]] = {
        MISFIT: _misfit,
        "fitted slopes": _slopes,
        MODEL_ERROR: _model_error,
        SCATTER: lambda design: _scatter(answer, design),
        BASE: _base,
        "largest contacts": _widths,
        INDEX: _plasticity,
    }
    found: list[Figure] = []
    for quantity, part in parts.items():
        try:
            judged = part(design)
        except MetafemError as error:
            judged = [_unknown(quantity, str(error))]
        found += [replace(figure, quantity=quantity) for figure in judged]
    return tuple(found)


def _misfit(design: Design) -> list[Figure]:
    name, value = misfit_words(design)
    bound = f"at most {percent(design.largest_misfit, '.3g')}"
    remedy = "Move the target towards the achieved law, or widen the limits."
    reached = design.status is not DesignStatus.MISSED
    return [_judged(name, value, bound, reached, design.status.value, remedy, ("law",))]


def _slopes(design: Design) -> list[Figure]:
    columns, rows = fit_table(design)
    name, (loads, unit) = design.target.wording.name(), columns[0].rstrip("]").split(" [")
    bound, found = design.largest_misfit, []
    remedy = "Give target.load_range, widen the limits, or change the target."
    for (branch, fit), (range_of_loads, target, value, difference, *_) in zip(design.fits, rows, strict=True):
        near = abs(fit.slope / branch.slope - 1.0) <= bound
        name_of_fit = f"fitted {name}, {loads} {range_of_loads} {unit}"
        words = (
            f"It differs from the target by {difference}; up to {percent(bound, '.3g')} counts as reached."
        )
        found.append(_judged(name_of_fit, value, f"target {target}", near, words, remedy, ("law",)))
    return found


def _model_error(design: Design) -> list[Figure]:
    """Return the figure for the estimated error of the law by its model."""
    name, error, model = MODEL_ERROR, design.law.model_error, design.law.model
    if math.isnan(error):
        return [_unknown(name, error.source)]
    words, remedy = f"Estimated by {error.source}.", ""
    size, value = float(error), percent(error)
    if not model.couples and error.load.size:
        near = reference_of(design.surface, model).substrate == HalfSpace()
        substrate = "half-space" if near else "layer"
        most, size = int(np.abs(error.change).argmax()), float(rms(error.change))
        value = f"{percent(size)} rms"
        way = "lowers" if error.change[most] < 0.0 else "raises"
        newtons = design.surface.material.composite_modulus * error.load[most]
        words = (
            f"Elastic interaction on the {substrate}, which this design leaves out, {way} the friction at a "
            f"given load by up to {percent(abs(error.change[most]))}, at {three_digits(newtons)} N."
        )
        remedy = f"Use the model {substrate}, or a larger pitch."
    bound, places = f"at most {percent(BOUND, 'g')}", ("law", "model.kind", "lattice.pitch")
    return [_judged(name, value, bound, size <= BOUND, words, remedy, places)]


def _scatter(answer: Answer, design: Design) -> list[Figure]:
    """Return the key numbers for the scatter of the law and of its slope among manufactured surfaces."""
    name, tolerances = "scatter of the law of made surfaces", band.tolerances_of(answer)
    if tolerances is None:
        words = 'State the errors of the part, for example limits.height_sd = "0.9 um".'
        return [Figure(name, "not stated", "", Standing.REMARK, words, ("limits.height_sd",))]
    errors = band.tolerance_words(tolerances)
    places = "law", "robust" if tolerances == design.robust else "limits.height_sd"

    def judged(name: str, sd: float, words: str) -> Figure:
        bound, remedy = (
            f"at most {percent(ALLOWED, 'g')}",
            "Make the part more accurately, or use more asperities.",
        )
        return _judged(name, f"{percent(sd)} SD", bound, sd <= ALLOWED, words, remedy, places)

    drawn, linear = band.drawn_of(answer), band.linear(answer)
    shown, found = drawn or linear, []
    if shown is not None:
        words = (
            f"By linear response to {errors}, rms over the loads. Random draws follow once nothing changes."
        )
        if drawn is not None:
            error = percent(1.0 / math.sqrt(2.0 * drawn.count), ".1g")
            words = (
                f"Of {drawn.count} drawn surfaces with {errors}, rms over the loads; sampling error {error}."
            )
        found.append(judged(name, float(rms(shown.sd / shown.mean)), words))
    if linear is None:
        words = "It is not computed at once for so many asperities; draw surfaces below."
        return found or [_unknown(name, words)]
    if np.ptp(design.surface.height) == 0.0:  # with equal heights a slope has no default load range
        return found
    fit = Slope.of(design.surface, None, design.law.model)
    response = design.law.model.gradient_model.sensitivity(design.surface, fit.load)
    slope = fit.weight @ response.curve.checked().area
    sd = band.deviations(tolerances, design.surface, (fit.weight @ response.gradient)[None])[0]
    ends = design.surface.material.composite_modulus * np.array(fit.load_range)
    low, high = map(three_digits, ends)
    words = f"By linear response to {errors}; fitted from {low} to {high} N, as in studies."
    return [*found, judged("scatter of the slope of made surfaces", float(sd / abs(slope)), words)]


def _base(design: Design) -> list[Figure]:
    """Return the figure for the load at which the plane touches the base between the summits."""
    name, last = BASE, design.law.load[-1]
    onset = design.surface.material.composite_modulus * base_contact_load(design.surface, design.law.model)
    value, bound, free = f"{three_digits(onset)} N", f"largest load {three_digits(last)} N", onset > last
    words = "The plane stays clear of the base up to the largest load." if free else (
        "Beyond this load the base carries a part that the law does not count: raise limits.offset, or use "
        "lighter loads."
    )  # fmt: skip
    return [_judged(name, value, bound, free, words, "", ("surface", "limits.offset"))]


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
    far = f"Order 3 of the interaction was compared with resolved contacts up to {COMPARED:g}."
    merged = f"{overlaps} pairs overlap, where real contacts merge: use a larger pitch or lighter loads."
    return [
        _judged(
            WIDTH, f"{wide:.2f} {newtons}", f"at most {WIDEST:g}", wide <= WIDEST,
            f"Small strain holds up to about {WIDEST:g}, with a fitted modulus.",
            "Use lighter loads, more asperities or larger radii.",
            ("surface", "lattice.radius"), wide <= TOO_WIDE,
        ),
        _judged(
            "contact radius over the distance to its neighbour", f"{ratio} {newtons}",
            f"at most {COMPARED:g}", near <= COMPARED, "Contacts that are far apart stay separate.",
            f"{far} {merged}" if overlaps else far, ("surface", "lattice.pitch"), not overlaps,
        ),
    ]  # fmt: skip


def _plasticity(design: Design) -> list[Figure]:
    """Return the figure for the plasticity index; an empty list if the specification has no hardness."""
    index = design.parameters.get("plasticity_index")
    if index is None:
        return []
    psi, words = float(np.asarray(index)), "Contacts of a surface with a smaller index stay elastic."
    remedy = "Use larger radii, closer heights or a material with a smaller E*/H."
    bound, places = f"below {ELASTIC_LIMIT:g}", ("surface", "checks.hardness")
    return [_judged(INDEX, f"{psi:.2g}", bound, psi < ELASTIC_LIMIT, words, remedy, places)]


def _judged(
    name: str,
    value: str,
    bound: str,
    good: bool,
    words: str,
    remedy: str,
    places: tuple[str, ...],
    tolerable: bool = False,
) -> Figure:
    """Return a figure with its rating; a figure that is not good names the remedy."""
    standing = Standing.GOOD if good else Standing.REMARK if tolerable else Standing.WARNING
    sentence = _sentence(words) if good else f"{_sentence(words)} {remedy}".rstrip()
    return Figure(name, value, bound, standing, sentence, places)


def _unknown(name: str, words: str) -> Figure:
    return Figure(name, "unknown", "", Standing.UNKNOWN, _sentence(words))


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:].rstrip(".") + "."
