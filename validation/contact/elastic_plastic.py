"""Elastic-plastic contacts: published formulas and their jumps, blends, limits, energy and second loading."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from metafem.contact.elastic_plastic import ElasticPlastic
from metafem.drawing import ACHIEVED, QUIET, TARGET
from metafem.reference import single_contacts
from metafem.reference.elastic_plastic import jackson_green, kogut_etsion
from validation.check import Check, Claim, Picture, Row, below, reported
from validation.figures import panels
from validation.sources import Source, closed_form, known_input, publication

RADIUS, MODULUS = 0.526, 1.36

# Laws that are compared with the formulas for P/P_c and A/A_c over w/w_c and Poisson's ratio.
EXAMPLES = {mf.KogutEtsion: mf.KogutEtsion(0.1), mf.JacksonGreen: mf.JacksonGreen(0.002)}
PUBLISHED = {mf.KogutEtsion: kogut_etsion, mf.JacksonGreen: partial(jackson_green, strain=0.002 / MODULUS)}

# Poisson's ratios, indentations w/w_c, and the breaks of the formulas in w/w_c.
RATIOS = (0.3, 0.4, 0.5)
INDENTATIONS = np.geomspace(0.1, 500.0, 3000)
BREAKS = {mf.KogutEtsion: (1.0, 6.0, 110.0), mf.JacksonGreen: (1.9,)}

WORDS = {mf.KogutEtsion: "Kogut and Etsion", mf.JacksonGreen: "Jackson and Green"}

# Two evaluations of one formula.
ROUNDING = 1e-12

FORMULAS = {
    mf.KogutEtsion: closed_form(kogut_etsion, "formulas of Kogut and Etsion (2002), outside the blends"),
    mf.JacksonGreen: closed_form(jackson_green, "formulas of Jackson and Green (2005), outside the blends"),
}
JUMP = "published formulas just above the break over those just below, minus 1"
BLENDED = (
    "law with blends over the published formulas, largest change at Poisson's ratios of 0.3, 0.4 and 0.5"
)
GROWS = known_input("identity: load and area of a contact grow with its indentation")
UNLOADED = publication("10.1016/j.ijsolstr.2004.12.006", "Etsion, Kligerman and Kadin, loss of height")
GAIN = known_input("identity: a cycle of loading and unloading gains no energy")
AGAIN = known_input("identity: the second loading reaches the state from which the first was unloaded")
HERTZ = closed_form(single_contacts.hertz, "Hertz's law, to which the law tends")


# Laws of a cycle of loading and unloading; indentations at yield and far beyond.
LAWS = (mf.KogutEtsion(0.02), mf.JacksonGreen(0.004))
STEPS = np.concatenate([1.0 + np.geomspace(1e-6, 1.0, 40), np.geomspace(2.1, 170.0, 40)])


def bound(law: mf.contact.Contact, ratio: float = 0.3) -> ElasticPlastic:
    """Return a law for the material of the check."""
    return law.for_material(mf.Material(MODULUS, ratio))


def claim() -> Claim:
    """The laws of Kogut and Etsion and of Jackson and Green are compared with their published formulas, which
    jump by up to 8 % between regimes for Poisson's ratios of 0.3 to 0.5, and by up to 37 % at 0. Cubics close
    the jumps so that Newton's method converges; the largest change by them is listed. Load and area grow with
    the indentation for all materials tried, hard materials follow Hertz's law, no cycle of loading and
    unloading gains energy, and a second loading returns to the first.
    """
    return Claim(
        "Elastic-plastic contacts and contacts of a table",
        [*_formulas(), *_growth(), *_limits(), *_cycles()],
        {
            "A cycle of loading and unloading": Picture(_picture),
            "Blends between the published formulas": Picture(_blends),
        },
    )


def relative(kind: type[ElasticPlastic], ratio: float) -> np.ndarray:
    """Return load and area of the law over the published ones, minus 1, at the indentations (k, 2)."""
    law = bound(EXAMPLES[kind], ratio)
    depth = law.yield_indentation(RADIUS)
    a = law.contact_radius(INDENTATIONS * depth, RADIUS)
    yielding = np.sqrt(depth * RADIUS)
    load, _ = single_contacts.hertz(float(yielding), RADIUS)
    found = np.column_stack([law.load(a, RADIUS) / load, (a / yielding) ** 2])
    return found / [PUBLISHED[kind](float(w), ratio) for w in INDENTATIONS] - 1.0


def _formulas() -> Iterator[Row]:
    """Compare the laws with the formulas outside the blends, and report jumps and blends."""
    for kind, breaks in BREAKS.items():
        name, outside, most = kind.__name__, 0.0, np.zeros(2)
        for ratio in RATIOS:
            law = bound(EXAMPLES[kind], ratio)
            inside = np.zeros(len(INDENTATIONS), dtype=bool)
            for blend in law.blends():
                inside |= (blend.start < INDENTATIONS) & (blend.end > INDENTATIONS)
            change = np.abs(relative(kind, ratio))
            outside, most = max(outside, change[~inside].max()), np.maximum(most, change.max(axis=0))
        label = f"{name}: largest relative error of load and area"
        yield below(label, outside, ROUNDING, FORMULAS[kind])
        for what, value in zip(("load", "area"), most, strict=True):
            yield reported(f"{name}: largest change of the {what} by the blends [%]", 1e2 * value, BLENDED)
        for ratio in (0.3, 0.5):
            for at in breaks:
                low, high = (PUBLISHED[kind](at * (1.0 + e), ratio) for e in (-ROUNDING, ROUNDING))
                for what, before, after in zip(("load", "area"), low, high, strict=True):
                    where = f"{name}, ν = {ratio}, jump of the {what} at {at:g} w_c [%]"
                    yield reported(where, 1e2 * (after / before - 1.0), JUMP)


def _growth() -> Iterator[Row]:
    """Check that load and area grow with the indentation, for soft and hard materials."""
    for kind in BREAKS:
        slopes = []
        for strain in np.geomspace(1e-3, 1.0, 25):
            for ratio in (0.0, 0.3, 0.5):
                law = kind(MODULUS * strain * kind.strength_ratio)
                d = np.geomspace(1e-6, 1.0, 400) * RADIUS
                a = bound(law, ratio).contact_radius(d, RADIUS)
                p = bound(law, ratio).load(a, RADIUS)
                slopes += [np.diff(np.log(p)).min(), np.diff(np.log(a)).min()]
        least = float(min(slopes))
        yield _positive(f"{kind.__name__}: least step of ln P and ln a", least, 0.0, GROWS)


def _positive(name: str, computed: float, limit: float, source: Source) -> Check:
    """Check that a number is larger than a limit."""
    return Check(name, computed, f"above {limit:g}", computed > limit, source)


def _limits() -> Iterator[Row]:
    """Compare hard materials and a table of Hertz's law with Hertz's closed form."""
    a = np.geomspace(1e-3, 0.4, 100)
    load, d = np.array([single_contacts.hertz(float(each), RADIUS) for each in a]).T
    edge = np.linspace(0.0, 0.4, 21) ** 0.5 * RADIUS**0.5  # equal steps of the indentation
    force, depth = np.array([single_contacts.hertz(float(each), RADIUS) for each in edge]).T
    table = mf.TabulatedContact(depth, MODULUS * force, np.pi * edge**2)
    for law, name, limit in (
        (mf.KogutEtsion(1e6), "KogutEtsion of a hard material", 1e-9),
        (mf.JacksonGreen(1e6), "JacksonGreen of a strong material", 1e-9),
        (table, "table of 21 points of Hertz's law", 1e-6),
    ):
        one = bound(law)
        found = one.contact_radius(d, RADIUS)
        parts = found / a, one.load(found, RADIUS) / load
        worst = max(float(np.abs(part - 1.0).max()) for part in parts)
        yield below(f"{name}: largest relative difference from Hertz's law", worst, limit, HERTZ)


def _cycles() -> Iterator[Row]:
    """Check the energy of cycles, and the second loading of a surface."""
    node, weight = np.polynomial.legendre.leggauss(30)
    height = 0.2 - np.random.default_rng(5).exponential(0.03, 64).clip(0.0, 0.15)
    surface = mf.Surface.square_lattice(height, radius=RADIUS, material=mf.Material(MODULUS, 0.3))
    for law in LAWS:
        one, lost, name, worst = bound(law), [], type(law).__name__, 0.0
        for largest in STEPS * one.yield_indentation(RADIUS):
            ends = one.indentation(np.append(0.0, one.breaks(RADIUS)), RADIUS)
            ends = np.append(ends[ends < largest], largest)
            # with d = x^2 the elastic load is a polynomial
            x = np.sqrt(ends[:-1]) + np.outer(0.5 * (node + 1.0), np.diff(np.sqrt(ends)))
            load = one.load(one.contact_radius(x**2, RADIUS), RADIUS) * 2.0 * x
            taken = float((weight @ load) @ (0.5 * np.diff(np.sqrt(ends))))
            after, loss = one.unloaded(np.array([largest]), np.array([RADIUS]))
            top = float(one.load(one.contact_radius(largest, RADIUS), RADIUS))
            worst = max(
                worst, abs(_lost(largest / float(one.yield_indentation(RADIUS))) * largest / loss[0] - 1.0)
            )
            lost.append(1.0 - top * (largest - loss[0]) / (after.load_exponent[0] + 1.0) / taken)
        least = float(min(lost))
        label = f"{name}: least share of the energy that is lost in a cycle, to rounding"
        yield _positive(label, least, -ROUNDING, GAIN)
        yield below(f"{name}: loss of height, largest relative error", worst, 1e-8, UNLOADED)
        for model in (mf.Independent(law), mf.Interacting(1, contact=law)):
            after, second = mf.flattened(surface, model, load=0.2)
            load = np.array([0.2, 0.3])
            again, first = (
                mf.friction_law(*pair, load=load).area for pair in ((after, second), (surface, model))
            )
            worst = float(np.abs(again / first - 1.0).max())
            how = "order 1" if model.couples else "independent"
            label = f"{name}, {how}: second loading at the earlier load and beyond, relative change of A0"
            yield below(label, worst, 1e-9, AGAIN)


def _lost(star: float) -> float:
    """Loss of height over the largest indentation, which is that at yield times `star`."""
    return (1.0 - star**-0.28) * (1.0 - star**-0.69)


@panels(8.0, 3.6, columns=2)
def _picture(*axes) -> None:
    """Load P/E* [mm²] of one contact over its indentation [µm], up to 60 times that at yield: first loading,
    Hertz's law of an elastic contact (grey), and unloading from two depths (dashed). Unloading ends at a
    residual depth, and the area between loading and unloading is the energy lost.
    """
    for ax, law in zip(axes, LAWS, strict=True):
        one = bound(law)
        d = np.linspace(0.0, 60.0, 400) * one.yield_indentation(RADIUS)
        ax.plot(
            1e3 * d, one.load(one.contact_radius(d, RADIUS), RADIUS), color=ACHIEVED, label="first loading"
        )
        a = mf.Hertz().contact_radius(d, RADIUS)
        ax.plot(1e3 * d, mf.Hertz().load(a, RADIUS), color=QUIET, lw=0.8, label="elastic")
        for largest in (d[150], d[-1]):
            after, loss = one.unloaded(np.array([largest]), np.array([RADIUS]))
            e = np.linspace(0.0, largest - loss[0], 100)
            back, label = after.one(0), "unloading" if largest == d[-1] else None
            ax.plot(
                1e3 * (e + loss[0]),
                back.load(back.contact_radius(e, RADIUS), RADIUS),
                "--",
                color=TARGET,
                label=label,
            )
        ax.set_title(WORDS[type(law)])
        ax.set_ylim(0.0, 1.2 * one.load(one.contact_radius(d[-1], RADIUS), RADIUS))
        ax.set_xlabel("indentation [µm]")
    axes[0].set_ylabel("P/E* [mm²]")
    axes[0].legend(frameon=False)


@panels(8.0, 3.4, columns=2, sharey=True)
def _blends(*axes) -> None:
    """Law with blends over the published formulas, minus 1 [%], over the indentation relative to that at
    yield, at a Poisson's ratio of 0.3. Steps are the jumps of the formulas; the law itself is continuous
    there. Between the blends the lines lie on zero.
    """
    for ax, kind in zip(axes, BREAKS, strict=True):
        load, area = 1e2 * relative(kind, 0.3).T
        ax.semilogx(INDENTATIONS, load, color=ACHIEVED, label="load")
        ax.semilogx(INDENTATIONS, area, color=TARGET, label="area")
        ax.set(title=WORDS[kind], xlabel="indentation  w/w_c")
    axes[0].set_ylabel("law over formulas, minus 1 [%]")
    axes[0].legend(frameon=False)
