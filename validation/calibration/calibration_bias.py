"""Bias of E* by interaction, layer, pedestal, cap shape and large strain, for five caps 7.1 mm apart."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import ContactCalibration, contact
from metafem.drawing import new_figure
from metafem.reference.single_contacts import hertz, sneddon_sphere
from validation.check import Check, Claim, below, near, reported
from validation.finite_elements.frozen_meshes import FOLDER, deep_caps
from validation.scenes.compression_tests import ENERGY, ERRORS, MODULUS, RADII, RADIUS

SLOW = True

# Published E* of batch 1 has the uncertainty 0.04 MPa.
PUBLISHED = 0.04 / MODULUS

# Positions of five caps 7.1 mm apart, the middle one and four on the diagonals, on the paper's block.
# Their height is not printed: contacts of a = 0.4 mm need caps of about 0.4 mm.
POSITION = 7.1 / math.sqrt(2.0) * np.array([[0.0, 0.0], [-1, -1], [1, -1], [-1, 1], [1, 1]])
SAMPLE = mf.Surface(POSITION, np.full(5, 0.4), RADIUS, mf.Material(MODULUS), block=mf.Block(20.0, 20.0, 7.2))

# The block's cells are coarser than usual: the influence changes by less than 1e-3 of the half-space's.
BLOCK = mf.fe.Block3D(cell=0.5, edge_cell=0.05)
MODELS = {
    "interaction on a half-space": mf.Interacting(),
    "interaction on a bonded layer": mf.Interacting(substrate=mf.BondedLayer()),
    "bonded layer and pedestals": mf.Interacting(substrate=mf.BondedLayer(), pedestal=True),
    "interaction on the block with free sides": mf.Interacting(substrate=BLOCK),
}

# Load over Hertz's at a/R, finite elements at large strain (neo-Hookean, nu = 1/2), printed to three digits.
SOFT = np.array([[0.095, 0.989], [0.19, 0.981], [0.35, 0.974], [0.43, 0.974]])

FITTED = "data of the named model without noise, fitted by Hertz's law of contacts far apart"
CLOSED = (
    "1/R + Σ P_j/(2πE*r³) and 3/8 of the variance of the sinkings ΣP_j/(πE*r) over d², by numpy.linalg.lstsq"
)
BY_HAND = (
    "weighted numpy.linalg.lstsq with the closed form of Sneddon (1965), doi:10.1016/0020-7225(65)90019-4"
)
BLOCK_AGAINST_LAYER = "bonded layer without sides; sides 5 mm from the outer caps change the influence"
SAME = "requirement: the model of the data is the model of the fit"
DIAGONAL = "a compliance that is equal for all caps changes the approach alone, at equal loads"
NEO_HOOKEAN = "ratios at four a/R of neo-Hookean finite elements, half of the last printed digit and 0.2 %"


@cache
def fitted_by_hertz(effect: str) -> ContactCalibration:
    """Return the fit of Hertz's law of contacts far apart to data of an effect, for the effect of a model."""
    return contact(*data(MODELS[effect]), RADIUS, contacts=5)


@cache
def data(model: mf.Interacting) -> tuple[FloatArray, FloatArray]:
    """Return loads and total areas of the sample under a model, at Hertz's loads of the contact radii."""
    load = 5.0 * MODULUS * mf.Hertz().load(RADII, RADIUS)
    return load, mf.friction_law(SAMPLE, model, load=load).area


def of_cap(cap: mf.contact.Contact, radii: FloatArray = RADII, energy: float = 0.0) -> ContactCalibration:
    """Return the fit of Hertz's law to the data of five caps of another law."""
    return contact(*pressed(cap, radii, energy), RADIUS, contacts=5)


def pressed(cap: mf.contact.Contact, radii: FloatArray, energy: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return loads and total areas of five caps."""
    lowered = np.sqrt(8.0 * math.pi * energy * MODULUS * radii**3)
    return 5.0 * (MODULUS * cap.load(radii, RADIUS) - lowered), 5.0 * math.pi * radii**2


@cache
def soft_cap(height: float) -> mf.TabulatedContact:
    """Return the law of a soft cap at large strain."""
    return mf.TabulatedContact(*deep_caps()[height].T).for_material(mf.Material(1.0))


def shift(found: ContactCalibration) -> float:
    """Return the relative error of E*."""
    return found.composite_modulus / MODULUS - 1.0


def by_hand(rescaled: FloatArray, radii: FloatArray = RADII) -> float:
    """Return the error of E* of a weighted line through loads P/E* of single caps, in closed forms only."""
    q = np.array([hertz(a, RADIUS)[0] for a in radii])
    area = math.pi * radii**2
    slope = np.gradient(MODULUS * rescaled, area, edge_order=2)
    weight = 1.0 / np.sqrt(ERRORS.load**2 + 5.0 * (slope * ERRORS.of_area(area)) ** 2)
    columns = np.stack([q, -np.sqrt(8.0 * math.pi * radii**3)], axis=1)
    (modulus, _), *_ = np.linalg.lstsq(weight[:, None] * columns, weight * MODULUS * rescaled, rcond=None)
    return float(modulus / MODULUS - 1.0)


def claim() -> Claim:
    """Fit Hertz's law to data of each effect, and the effect's own law."""
    return Claim(
        "Bias of E* by what the calibration leaves out",
        [*_interaction(), *_sphere(), *_large_strain()],
        {"loads over Hertz's": _figure},
        "Loads of five caps at contact radii from 0.08 to 0.4 mm, a/R = 0.15 to 0.76, without noise. "
        "Interaction on any base changes E* by 2 to 4 parts in ten thousand, a hundredth of the published "
        "±0.04 MPa (2.9 %), and pedestals do not change it. The shape of the caps must not be corrected "
        "alone: the law of a sphere at small strain would change E* by half, and large strain takes "
        "nearly all of that back. What is left of both is within 5 %. Fitted up to a/R = 0.5, E* is 3 to "
        "5 % below that of the material at small strain, which ±0.04 MPa does not quite cover. Fitted up "
        "to a/R = 0.76, it is off by −2 to +3 %, depending on the height of the caps, which ±0.04 MPa "
        "covers; an apparent adhesion energy of 2 to 16 mJ/m² takes up the rest (at most 2 mJ/m² by the "
        "paper's line), so that w from data that reach so far is not adhesion alone. Predictions by "
        "Hertz's law need the E* that was fitted by Hertz's law over the same contact radii.",
    )


def _interaction() -> list[Check]:
    shifts = {name: shift(fitted_by_hertz(name)) for name in MODELS}
    checks = []
    for name, model in MODELS.items():
        own = contact(*data(model), RADIUS, contacts=5, model=model, surface=SAMPLE)
        checks += [
            reported(f"{name}: bias of E*", shifts[name], FITTED),
            below(
                f"{name}: bias over the published uncertainty", abs(shifts[name]) / PUBLISHED, 0.02, FITTED
            ),
            near(f"{name}: E* by the same model [MPa]", own.composite_modulus, MODULUS, 1e-6, SAME),
        ]
    half, layer, pedestals, block = shifts.values()
    a, third = RADII, np.array([hertz(radius, RADIUS)[0] for radius in RADII])
    distance = np.hypot(*(POSITION[:, None] - POSITION).transpose(2, 0, 1)) + np.diag(np.full(5, np.inf))
    curvature = third * (distance**-3.0).sum(axis=1).mean() / (2.0 * math.pi)
    sinking = third * (1.0 / distance).sum(axis=1).std() / math.pi
    # P ~ A^(3/2) is convex: unequal contacts bear more at the same total area
    unequal = 0.375 * (sinking / (a**2 / RADIUS)) ** 2
    expected = by_hand(third * (1.0 + RADIUS * curvature + unequal))
    return [
        *checks,
        near(
            "interaction on a half-space: bias of E* in closed form", half, expected, 0.1 * expected, CLOSED
        ),
        near("block with free sides against the layer, bias of E*", block, layer, 2e-4, BLOCK_AGAINST_LAYER),
        below("change of the bias by pedestals", abs(pedestals - layer), 1e-6, DIAGONAL),
    ]


def _sphere() -> list[Check]:
    found = of_cap(mf.SphericalCap())
    own = contact(*pressed(mf.SphericalCap(), RADII), RADIUS, contacts=5, contact=mf.SphericalCap())
    light = RADII[RADII < 0.25 * RADIUS]
    expected = by_hand(np.array([sneddon_sphere(radius, RADIUS)[0] for radius in light]), light)
    return [
        reported("small-strain sphere: bias of E*, a/R up to 0.76", shift(found), FITTED),
        reported("small-strain sphere: apparent w [mJ/m²], true 0", 1e6 * found.adhesion_energy, FITTED),
        near(
            "small-strain sphere: bias of E*, a/R up to 0.25",
            *(shift(of_cap(mf.SphericalCap(), light)), expected, 0.02 * expected, BY_HAND),
        ),
        near("small-strain sphere: E* by the same law [MPa]", own.composite_modulus, MODULUS, 1e-9, SAME),
    ]


def _large_strain() -> list[Check]:
    checks = []
    half = np.linspace(RADII[0], 0.5 * RADIUS, len(RADII))
    for height in deep_caps():
        name = f"large strain, cap {height:g} mm high"
        cap = soft_cap(height)
        small, large = of_cap(cap, half), of_cap(cap)
        own = contact(*pressed(cap, RADII, ENERGY), RADIUS, contacts=5, contact=cap)
        checks += [
            reported(f"{name}: bias of E*, a/R up to 0.5", shift(small), FITTED),
            reported(f"{name}: bias of E*, a/R up to 0.76", shift(large), FITTED),
            reported(
                f"{name}: apparent w [mJ/m²], a/R up to 0.76, true 0", 1e6 * large.adhesion_energy, FITTED
            ),
            reported(
                f"{name}: the same by the paper's line [mJ/m²]", 1e6 * large.line.adhesion_energy, FITTED
            ),
            near(f"{name}: E* by the same law [MPa]", own.composite_modulus, MODULUS, 1e-9, SAME),
            near(f"{name}: w by the same law [mJ/m²]", 1e6 * own.adhesion_energy, 1e6 * ENERGY, 1e-6, SAME),
        ]
    ratio, bears = SOFT.T
    radii = ratio * RADIUS
    printed = by_hand(bears * np.array([hertz(a, RADIUS)[0] for a in radii]), radii)
    table = mf.TabulatedContact(*np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1).T)
    found = by_hand(table.for_material(mf.Material(1.0)).load(radii, RADIUS), radii)
    return [
        *checks,
        near(
            "large strain, cap 0.2 mm high: bias of E* from four loads, a/R up to 0.43",
            *(found, printed, 5e-3, NEO_HOOKEAN),
        ),
        below(
            "large strain: largest bias of E*, a/R up to 0.5, over the published uncertainty",
            max(abs(shift(of_cap(soft_cap(height), half))) for height in deep_caps()) / PUBLISHED,
            *(2.0, FITTED),
        ),
    ]


def _figure():
    figure = new_figure(6.4, 3.6)
    ax = figure.add_subplot()
    a = np.linspace(RADII[0], RADII[-1], 200)
    alone = mf.Hertz().load(a, RADIUS)
    ax.plot(a / RADIUS, mf.SphericalCap().load(a, RADIUS) / alone, label="sphere at small strain")
    for height in deep_caps():
        ax.plot(
            a / RADIUS, soft_cap(height).load(a, RADIUS) / alone, label=f"large strain, {height:g} mm high"
        )
    load, area = data(MODELS["interaction on the block with free sides"])
    radii = np.sqrt(area / (5.0 * math.pi))
    alone = 5.0 * MODULUS * mf.Hertz().load(radii, RADIUS)
    ax.plot(radii / RADIUS, load / alone, "k.", ms=4.0, label="five caps on the block")
    ax.set_xlabel("contact radius over R")
    ax.set_ylabel("load over Hertz's")
    ax.set_ylim(0.93, 1.2)
    ax.legend(frameon=False, fontsize="small")
    return figure
