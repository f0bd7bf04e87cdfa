"""Elastic-plastic contacts: printed jumps and their blends, limits, energy lost and second loading."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.contact.elastic_plastic import ElasticPlastic
from metafem.drawing import new_figure
from validation.check import Check, Claim, below, near
from validation.finite_elements.frozen_meshes import FOLDER

RADIUS, MODULUS = 0.526, 1.36

PRINTED = "jumps of the published formulas, half of the last printed digit"
LIMIT = "limit of the law, requirement of this check"
NUMBERS = "numbers of the docstring"

# Break in w/w_c with the printed jumps of load and area, by law and Poisson's ratio.
JUMPS = (
    (mf.KogutEtsion(0.1), 0.3, 1.0, 0.03, -0.07, 5e-3),
    (mf.KogutEtsion(0.1), 0.3, 6.0, 0.017, 0.029, 5e-4),
    (mf.KogutEtsion(0.1), 0.3, 110.0, 0.079, 0.071, 5e-4),
    (mf.KogutEtsion(0.1), 0.5, 110.0, -0.055, 0.071, 5e-4),
    (mf.JacksonGreen(0.002), 0.3, 1.9, 0.005, 0.0, 5e-4),
    (mf.JacksonGreen(0.002), 0.5, 1.9, -0.034, 0.0, 5e-4),
)

# Largest change of load and area by the blends, over all Poisson's ratios from 0.3 to 0.5.
LARGEST_CHANGE = {mf.KogutEtsion(0.1): (0.052, 0.076), mf.JacksonGreen(0.002): (0.041, 0.016)}

# Laws of a cycle of loading and unloading; indentations at yield and far beyond.
LAWS = (mf.KogutEtsion(0.02), mf.JacksonGreen(0.004))
STEPS = np.concatenate([1.0 + np.geomspace(1e-6, 1.0, 40), np.geomspace(2.1, 170.0, 40)])


def bound(law: mf.contact.Contact, ratio: float = 0.3) -> ElasticPlastic:
    """Return a law for the material of the check."""
    return law.for_material(mf.Material(MODULUS, ratio))


def claim() -> Claim:
    """Check the laws of Kogut and Etsion and of Jackson and Green, and laws of tables."""
    return Claim(
        "Elastic-plastic contacts and contacts of a table",
        [*_jumps(), *_blends(), *_limits(), *_cycles(), *_soft_cap()],
        {"a cycle of loading and unloading": _picture},
    )


def _jumps() -> list[Check]:
    checks = []
    for law, ratio, at, load, area, half in JUMPS:
        low, high = (bound(law, ratio)._published(np.asarray(at * (1.0 + e))) for e in (-1e-12, 1e-12))
        name = f"{type(law).__name__}, nu = {ratio}, jump at {at:g} w_c"
        checks.append(near(f"{name}, load", float(high[0] / low[0]) - 1.0, load, half, PRINTED))
        checks.append(near(f"{name}, area", float(high[1] / low[1]) - 1.0, area, half, PRINTED))
    return checks


def _blends() -> list[Check]:
    checks = []
    for law, (load, area) in LARGEST_CHANGE.items():
        blends = [one for ratio in (0.3, 0.4, 0.5) for one in bound(law, ratio).blends()]
        name = type(law).__name__
        most = max(max(map(abs, one.load_change)) for one in blends)
        checks.append(below(f"{name}, change of the load by the cubics", most, load, NUMBERS))
        most = max(max(map(abs, one.area_change)) for one in blends)
        checks.append(below(f"{name}, change of the area by the cubics", most, area, NUMBERS))
        slopes = []
        for strain in np.geomspace(1e-3, 1.0, 25):
            for ratio in (0.0, 0.3, 0.5):
                one = type(law)(MODULUS * strain * (2.8 if isinstance(law, mf.KogutEtsion) else 1.0))
                d = np.geomspace(1e-6, 1.0, 400) * RADIUS
                a = bound(one, ratio).contact_radius(d, RADIUS)
                p = bound(one, ratio).load(a, RADIUS)
                slopes += [np.diff(np.log(p)).min(), np.diff(np.log(a)).min()]
        least = float(min(slopes))
        source = "load and area increase for all materials"
        checks.append(Check(f"{name}, least step of ln P and ln a", least, "above 0", least > 0.0, source))
    return checks


def _limits() -> list[Check]:
    hertz, d = mf.Hertz(), np.geomspace(1e-6, 0.4, 100)
    a = hertz.contact_radius(d, RADIUS)
    coarse = np.linspace(0.0, 0.4, 21)
    edge = hertz.contact_radius(coarse, RADIUS)
    table = mf.TabulatedContact(coarse, MODULUS * hertz.load(edge, RADIUS), hertz.area(edge))
    checks = []
    for law, name, limit in (
        (mf.KogutEtsion(1e6), "KogutEtsion of a hard material", 1e-9),
        (mf.JacksonGreen(1e6), "JacksonGreen of a strong material", 1e-9),
        (table, "table of 21 points of Hertz's law", 1e-6),
    ):
        one = bound(law)
        parts = one.contact_radius(d, RADIUS) / a, one.load(a, RADIUS) / hertz.load(a, RADIUS)
        worst = max(float(np.abs(part - 1.0).max()) for part in parts)
        checks.append(below(f"{name} against Hertz's law", worst, limit, LIMIT))
    return checks


def _cycles() -> list[Check]:
    node, weight = np.polynomial.legendre.leggauss(30)
    checks = []
    height = 0.2 - np.random.default_rng(5).exponential(0.03, 64).clip(0.0, 0.15)
    surface = mf.Surface.square_lattice(height, radius=RADIUS, material=mf.Material(MODULUS, 0.3))
    for law in LAWS:
        one, lost, name = bound(law), [], type(law).__name__
        for largest in STEPS * one.yield_indentation(RADIUS):
            ends = one.indentation(np.append(0.0, one.breaks(RADIUS)), RADIUS)
            ends = np.append(ends[ends < largest], largest)
            # with d = x^2 the elastic load is a polynomial
            x = np.sqrt(ends[:-1]) + np.outer(0.5 * (node + 1.0), np.diff(np.sqrt(ends)))
            load = one.load(one.contact_radius(x**2, RADIUS), RADIUS) * 2.0 * x
            taken = float((weight @ load) @ (0.5 * np.diff(np.sqrt(ends))))
            after, loss = one.unloaded(np.array([largest]), np.array([RADIUS]))
            top = float(one.load(one.contact_radius(largest, RADIUS), RADIUS))
            lost.append(1.0 - top * (largest - loss[0]) / (after.load_exponent[0] + 1.0) / taken)
        least = float(min(lost))
        source = "no cycle gains energy, to rounding"
        checks.append(
            Check(f"{name}, least share of energy lost", least, "at least -1e-12", least >= -1e-12, source)
        )
        for model in (mf.Independent(law), mf.Interacting(1, contact=law)):
            after, second = mf.flattened(surface, model, load=0.2)
            load = np.array([0.2, 0.3])
            again, first = (
                mf.friction_law(*pair, load=load).area for pair in ((after, second), (surface, model))
            )
            worst = float(np.abs(again / first - 1.0).max())
            label = (
                f"{name}, {'order 1' if model.couples else 'independent'}: second loading at the earlier load"
            )
            checks.append(below(f"{label} and beyond, area", worst, 1e-9, LIMIT))
    return checks


def _soft_cap() -> list[Check]:
    indentation, load, area = np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1).T
    law = mf.TabulatedContact(indentation, load, area).for_material(mf.Material(1.0))
    source = "finite elements at large strain, 0.2 % of the mesh and half of the last printed digit"
    return [
        near(
            f"soft cap at large strain, P over Hertz's at a/R = {ratio:g}",
            float(law.load(ratio * RADIUS, RADIUS) / mf.Hertz().load(ratio * RADIUS, RADIUS)),
            *(expected, 2.5e-3, source),
        )
        for ratio, expected in ((0.095, 0.989), (0.19, 0.981), (0.35, 0.974), (0.43, 0.974))
    ]


def _picture():
    figure = new_figure(8.0, 3.6)
    for ax, law in zip(figure.subplots(1, 2), LAWS, strict=True):
        one = bound(law)
        d = np.linspace(0.0, 60.0, 400) * one.yield_indentation(RADIUS)
        ax.plot(d, one.load(one.contact_radius(d, RADIUS), RADIUS), label="first loading")
        a = mf.Hertz().contact_radius(d, RADIUS)
        ax.plot(d, mf.Hertz().load(a, RADIUS), color="grey", lw=0.8, label="elastic")
        for largest in (d[150], d[-1]):
            after, loss = one.unloaded(np.array([largest]), np.array([RADIUS]))
            e = np.linspace(0.0, largest - loss[0], 100)
            back = after.one(0)
            ax.plot(e + loss[0], back.load(back.contact_radius(e, RADIUS), RADIUS), "--", color="C1")
        ax.set_title(type(law).__name__)
        ax.set_ylim(0.0, 1.2 * one.load(one.contact_radius(d[-1], RADIUS), RADIUS))
        ax.set_xlabel("indentation [mm]")
    figure.axes[0].set_ylabel("P/E* [mm²]")
    figure.axes[0].legend(frameon=False)
    return figure
