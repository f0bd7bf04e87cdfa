"""Conductance, stiffness and pull-off force against second methods, closed forms and resolved contacts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.reference import single_contacts
from validation.check import Claim, Picture, Row, below, near, reported
from validation.fidelity.order3_against_resolved import irregular
from validation.figures import panels
from validation.scenes.quantities import (
    BLOCK,
    CELL,
    ENERGY,
    LOADS,
    MATERIAL,
    RADIUS,
    discs_by_images,
    error,
)
from validation.sources import closed_form, second_method, self_consistency

# Resolved contacts take some seconds.
SLOW = True

# Relative step of the load for the stiffness by differences, and the accuracy of these.
STEP, DIFFERENCE = 1e-4, 1e-6

IMAGES = second_method(discs_by_images, "discs whose potentials add up, with images of the grounded base")
RESOLVED = second_method(mf.BoundaryElements, "resolved contacts")
BARBER = self_consistency(mf.friction_law, "Barber's identity with the differences of the separation")
JKR = closed_form(single_contacts.jkr_contact_radius, "pull-off force of one contact, 3/2 pi w R")


def claim() -> Claim:
    """The conductance of a surface follows from discs whose potentials add up, its stiffness from the contact
    equations; on a half-space Barber's identity relates the two. Where the base of the layer is grounded the
    identity does not hold, and the potentials are computed a second time from images. Stiffness and
    conductance are compared with resolved contacts, and the pull-off force of one contact with JKR's theory.
    """
    rows = [*_half_space(), *_layer(), *_pull_off()]
    return Claim("Stiffness, conductance and pull-off force", rows, {"Three stiffnesses": Picture(_figure)})


def _differences(model: mf.Model, surface: mf.Surface) -> FloatArray:
    """Return dP/dx over E* [mm] at `LOADS`, by central differences of the approach."""
    up, down = (model.curve(surface, (1.0 + sign * STEP) * LOADS).approach for sign in (1.0, -1.0))
    return np.asarray(2.0 * STEP * LOADS / (up - down))


def _half_space() -> Iterator[Row]:
    surface = irregular().surface
    for name, model in {"order 1": mf.Interacting(1), "order 3": mf.Interacting()}.items():
        found, expected = model.conductance(surface, LOADS), _differences(model, surface)
        for load, value, stiffness in zip(LOADS, found, expected, strict=True):
            label = f"half-space, {name}: rescaled conductance at P/E* = {load:g} mm² [mm]"
            yield near(label, value, stiffness, DIFFERENCE * stiffness, BARBER)
    exact = mf.BoundaryElements(CELL).curve(surface, LOADS).stiffness
    off = error(mf.Interacting().curve(surface, LOADS).stiffness, exact)
    yield below("half-space, order 3: relative error of the stiffness", off, 1e-3, RESOLVED)


def _layer() -> Iterator[Row]:
    surface, layer = irregular().surface.replaced(block=BLOCK), mf.BondedLayer()
    first = mf.Interacting(1, substrate=layer).conductance(surface, LOADS)
    for load, value, expected in zip(LOADS, first, discs_by_images(surface), strict=True):
        label = f"grounded layer, order 1: rescaled conductance at P/E* = {load:g} mm² [mm]"
        yield near(label, value, expected, 1e-10 * expected, IMAGES)
    model, resolved = mf.Interacting(substrate=layer), mf.BoundaryElements(CELL, substrate=layer)
    found = model.conductance(surface, LOADS)
    off = error(found, resolved.conductance(surface, LOADS))
    yield below("grounded layer, order 3: relative error of the conductance", off, 1e-3, RESOLVED)
    words = "order 3 on the bonded layer, which Barber's identity does not describe"
    ratio = model.curve(surface, LOADS).stiffness / found
    yield reported("stiffness k/E* over the rescaled conductance, largest", float(ratio.max()), words)


def _pull_off() -> Iterator[Row]:
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    expected = 1.5e6 * np.pi * ENERGY * RADIUS
    found = 1e6 * mf.pull_off(one, mf.Independent(mf.JKR(ENERGY)), load=0.01)
    yield near("pull-off force of one contact [µN]", found, expected, 1e-9 * expected, JKR)


@panels(6.0, 3.4)
def _figure(ax):
    """Normal contact stiffness k/E* of 64 equal asperities over the load: interaction lowers it much more
    than it changes the area, and less on a bonded layer than on a half-space.
    """
    lattice = mf.Surface.square_lattice(0.1, radius=RADIUS, material=MATERIAL, block=BLOCK)
    load = np.linspace(0.01, 0.5, 40)
    models = {
        "independent": mf.Independent(),
        "bonded layer": mf.Interacting(substrate=mf.BondedLayer()),
        "half-space": mf.Interacting(),
    }
    for name, model in models.items():
        ax.plot(load, model.curve(lattice, load).stiffness, label=name)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("stiffness  k/E* [mm]")
    ax.legend(frameon=False)
