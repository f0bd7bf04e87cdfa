"""Elastic-plastic contacts: published formulas and their jumps, blends and limits."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from metafem import reference
from metafem.contact.by_indentation import ElasticPlastic
from metafem.drawing import ACHIEVED, TARGET
from metafem.reference import jackson_green, kogut_etsion
from validation.check import Claim, Picture, Row, below, reported
from validation.figures import panels
from validation.sources import closed_form

RADIUS, MODULUS = 0.526, 1.36

# Laws that are compared with the formulas for P/P_c and A/A_c over w/w_c and Poisson's ratio.
EXAMPLES = {mf.KogutEtsion: mf.KogutEtsion(0.1), mf.JacksonGreen: mf.JacksonGreen(0.002)}
PUBLISHED = {mf.KogutEtsion: kogut_etsion, mf.JacksonGreen: partial(jackson_green, strain=0.002 / MODULUS)}

# Poisson's ratios, indentations w/w_c.
RATIOS = (0.3, 0.4, 0.5)
INDENTATIONS = np.geomspace(0.1, 500.0, 3000)

WORDS = {mf.KogutEtsion: "Kogut and Etsion", mf.JacksonGreen: "Jackson and Green"}

# Two evaluations of one formula.
ROUNDING = 1e-12

FORMULAS = {
    mf.KogutEtsion: closed_form(kogut_etsion, "formulas of Kogut and Etsion (2002), outside the blends"),
    mf.JacksonGreen: closed_form(jackson_green, "formulas of Jackson and Green (2005), outside the blends"),
}
BLENDED = (
    "law with blends over the published formulas, largest change at Poisson's ratios of 0.3, 0.4 and 0.5"
)
HERTZ = closed_form(reference.hertz, "Hertz's law, to which the law tends")


def bound(law: mf.contact.Contact, ratio: float = 0.3) -> ElasticPlastic:
    """Return a law for the material of the check."""
    return law.for_material(mf.Material(MODULUS, ratio))


def claim() -> Claim:
    """The laws of Kogut and Etsion and of Jackson and Green are compared with their published formulas, which
    jump by up to 8 % between regimes for Poisson's ratios of 0.3 to 0.5, and by up to 37 % at 0. Cubics close
    the jumps so that Newton's method converges; the largest change by them is listed. Hard materials follow
    Hertz's law.
    """
    figures = {"Blends between the published formulas": Picture(_blends)}
    return Claim("Elastic-plastic contacts", [*_formulas(), *_limits()], figures)


def relative(kind: type[ElasticPlastic], ratio: float) -> np.ndarray:
    """Return load and area of the law over the published ones, minus 1, at the indentations (k, 2)."""
    law = bound(EXAMPLES[kind], ratio)
    depth = law.yield_indentation(RADIUS)
    a = law.contact_radius(INDENTATIONS * depth, RADIUS)
    yielding = np.sqrt(depth * RADIUS)
    load, _ = reference.hertz(float(yielding), RADIUS)
    found = np.column_stack([law.load(a, RADIUS) / load, (a / yielding) ** 2])
    return found / [PUBLISHED[kind](float(w), ratio) for w in INDENTATIONS] - 1.0


def _formulas() -> Iterator[Row]:
    """Compare the laws with the formulas outside the blends, and report jumps and blends."""
    for kind in EXAMPLES:
        name, outside, most = kind.__name__, 0.0, np.zeros(2)
        for ratio in RATIOS:
            law = bound(EXAMPLES[kind], ratio)
            inside = np.zeros(len(INDENTATIONS), dtype=bool)
            for start, end, *_ in law.blends():
                inside |= (start < INDENTATIONS) & (end > INDENTATIONS)
            change = np.abs(relative(kind, ratio))
            outside, most = max(outside, change[~inside].max()), np.maximum(most, change.max(axis=0))
        label = f"{name}: largest relative error of load and area"
        yield below(label, outside, ROUNDING, FORMULAS[kind])
        for what, value in zip(("load", "area"), most, strict=True):
            yield reported(f"{name}: largest change of the {what} by the blends [%]", 1e2 * value, BLENDED)


def _limits() -> Iterator[Row]:
    """Compare hard materials with Hertz's closed form."""
    a = np.geomspace(1e-3, 0.4, 100)
    load, d = np.array([reference.hertz(float(each), RADIUS) for each in a]).T
    for law, name, limit in (
        (mf.KogutEtsion(1e6), "KogutEtsion of a hard material", 1e-9),
        (mf.JacksonGreen(1e6), "JacksonGreen of a strong material", 1e-9),
    ):
        one = bound(law)
        found = one.contact_radius(d, RADIUS)
        parts = found / a, one.load(found, RADIUS) / load
        worst = max(float(np.abs(part - 1.0).max()) for part in parts)
        yield below(f"{name}: largest relative difference from Hertz's law", worst, limit, HERTZ)


@panels(8.0, 3.4, columns=2, sharey=True)
def _blends(*axes) -> None:
    """Law with blends over the published formulas, minus 1 [%], over the indentation relative to that at
    yield, at a Poisson's ratio of 0.3. Steps are the jumps of the formulas; the law itself is continuous
    there. Between the blends the lines lie on zero.
    """
    for ax, kind in zip(axes, EXAMPLES, strict=True):
        load, area = 1e2 * relative(kind, 0.3).T
        ax.semilogx(INDENTATIONS, load, color=ACHIEVED, label="load")
        ax.semilogx(INDENTATIONS, area, color=TARGET, label="area")
        ax.set(title=WORDS[kind], xlabel="indentation  w/w_c")
    axes[0].set_ylabel("law over formulas, minus 1 [%]")
    axes[0].legend(frameon=False)
