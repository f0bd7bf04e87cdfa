"""A synthetic laboratory: images and forces of a calibration sample and of a made part.

The true material obeys JKR contacts of spheres of given adhesion energy. Sheared contacts are ellipses of the
area B A0, shorter in the direction of shear, and the friction force is their area times the shear strength.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasurementErrors
from validation.scenes.pictures import picture

# The material of batch 1 of the paper and the shear strength of Fig. 4, red.
MATERIAL = mf.Material(1.36)
ADHESION_ENERGY = 9e-6  # N/mm
FRICTION = mf.Friction(0.358, 0.85)
RADIUS, BLOCK = 0.526, mf.Block(20.0, 20.0, 7.2)

# Five caps, more than 7.1 mm apart as in the paper.
CORNER = 5.05
FIVE = CORNER * np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])

# Rotation of the camera against the lattice [rad], and the shift of its frame [mm].
CAMERA, SHIFT = math.radians(1.5), np.array([0.07, -0.04])


@dataclass(frozen=True)
class Series:
    """Images of one test, each before shear and at the peak of the friction force, with the forces.

    `load` and `friction_force` [N] are measured; `area` (k, n) [mm^2] are the true areas before shear.
    """

    surface: mf.Surface
    load: FloatArray
    friction_force: FloatArray
    area: FloatArray
    pixel: float
    width: float
    seed: int

    def image(self, number: int, sheared: bool) -> NDArray[np.uint8]:
        """Return one 8-bit image, with blur, noise and a gradient of the illumination."""
        side = round(self.width / self.pixel)
        radius = np.sqrt(self.area[number] / math.pi)
        closed = radius > 0.0
        ratio = FRICTION.area_ratio if sheared else 1.0
        axes = np.column_stack([ratio * radius, radius])[closed]
        turn = np.array([[math.cos(CAMERA), -math.sin(CAMERA)], [math.sin(CAMERA), math.cos(CAMERA)]])
        centre = self.surface.position[closed] @ turn.T + SHIFT + 0.5 * self.width
        light = {"blur": 1.5, "noise": 0.05, "gradient": (0.15, -0.1), "bits": 8}
        shown = centre / self.pixel, axes / self.pixel, CAMERA
        return picture((side, side), *shown, **light, rng=(self.seed, number, int(sheared)))

    def images(self, sheared: bool = False) -> Iterator[NDArray[np.uint8]]:
        """Yield all images, in the order of the loads."""
        for number in range(len(self.load)):
            yield self.image(number, sheared)


def calibration_sample() -> mf.Surface:
    """Return the sample of five caps of one height."""
    return mf.Surface(FIVE, np.full(5, 0.15), RADIUS, MATERIAL, FRICTION, BLOCK)


def measured(
    surface: mf.Surface,
    load: FloatArray,
    *,
    pixel: float = 0.01,
    seed: int = 0,
    errors: MeasurementErrors | None = None,
) -> Series:
    """Press and shear a surface at true loads [N]; the returned forces have the errors of the instruments."""
    rng = np.random.default_rng(seed)
    noise = errors or MeasurementErrors()
    law = mf.Independent(contact=mf.JKR(ADHESION_ENERGY))
    true = surface.replaced(material=MATERIAL, friction=FRICTION)
    area = np.array([mf.equilibrium(true, law, load=each).asperity_area for each in load.tolist()])
    force = FRICTION.shear_strength * FRICTION.area_ratio * area.sum(axis=1)
    found = load + noise.of_load(load) * rng.standard_normal(load.shape)
    friction = force + noise.of_friction_force(force) * rng.standard_normal(load.shape)
    width = float(np.ptp(surface.position, axis=0).max()) + 2.0  # 1 mm around the outermost sites
    return Series(true, found, friction, area, pixel, width, seed)


def calibration_tests(count: int = 3, loads: int = 10, pixel: float = 0.01) -> list[Series]:
    """Return tests of the calibration sample, up to contact radii of .4 mm on each of its caps."""
    # the loads of five contacts of these radii under Hertz's law; .4 mm is the largest of the paper
    radius = np.linspace(0.08, 0.4, loads)
    load = 5.0 * 4.0 / 3.0 * MATERIAL.composite_modulus * radius**3 / RADIUS
    return [measured(calibration_sample(), load, pixel=pixel, seed=number + 1) for number in range(count)]


# Errors of the made part: scale of its heights, s.d. of each [mm] and tilt [rad].
MADE = {"scale": 1.015, "height_sd": 9e-4, "angle": 3e-4}

# Loads of the part over that at which the plane reaches its lowest asperity; as many as points in Fig. 4.
LOADS = np.linspace(0.05, 1.2, 16)


def made(design: mf.Surface, seed: int = 7) -> mf.Surface:
    """Return a surface as made and mounted: heights scaled, with random errors, and tilted along x."""
    scaled = design.replaced(height=MADE["scale"] * design.height)
    return scaled.perturbed(MADE["height_sd"], rng=seed).tilted(MADE["angle"], 0.0)


def part_test(design: mf.Surface, pixel: float = 0.01) -> Series:
    """Return the measurement of the made part of a design."""
    lowest = mf.equilibrium(design, separation=float(design.height.min())).load
    return measured(made(design), LOADS * lowest, pixel=pixel, seed=20)
