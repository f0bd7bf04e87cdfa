"""Writes synthetic raw data of a laboratory: images and forces of a calibration sample, and of a made part.

`python -m validation.laboratory lab` writes the calibration sample, and the specification of a surface
without its material. `python -m validation.laboratory lab --part DIR` makes the design of a result folder,
with errors, and measures it.

The true material obeys JKR contacts of given adhesion energy; those of the part interact as in the model of
its design. Sheared contacts are ellipses of the
area B A0, shorter in the direction of shear, and the friction force is their area times the shear strength.
"""

from __future__ import annotations

import math
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasurementErrors
from metafem.models import Model
from validation.scenes.pictures import picture

# The material of batch 1 of the paper and the shear strength of Fig. 4, red.
MATERIAL = mf.Material(1.36)
ADHESION_ENERGY = 9e-6  # N/mm
FRICTION = mf.Friction(0.358, 0.85)
RADIUS, BLOCK = 0.526, mf.Block(20.0, 20.0, 7.2)

# Five caps, more than 7.1 mm apart as in the paper.
CORNER = 5.05
FIVE = CORNER * np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])

# Errors of the made part: scale of its heights, s.d. of each [mm] and tilt [rad].
SCALE, HEIGHT_SD, TILT = 1.015, 9e-4, 3e-4

# Loads of the part over that at which the plane reaches its lowest asperity; as many as points in Fig. 4.
LOADS = np.linspace(0.05, 1.2, 16)

# Length of a pixel [mm]; rotation of the camera against the lattice [rad], and the shift of its frame [mm].
PIXEL, CAMERA, SHIFT = 0.01, math.radians(1.5), np.array([0.07, -0.04])


@dataclass(frozen=True)
class Series:
    """Images of one test, each before shear and at the peak of the friction force, with the forces.

    `load` and `friction_force` [N] are measured; `area` (k, n) [mm^2] are the true areas before shear.
    """

    surface: mf.Surface
    load: FloatArray
    friction_force: FloatArray
    area: FloatArray
    width: float
    seed: int

    def image(self, number: int, sheared: bool) -> NDArray[np.uint8]:
        """Return one 8-bit image, with blur, noise and a gradient of the illumination."""
        side = round(self.width / PIXEL)
        radius = np.sqrt(self.area[number] / math.pi)
        closed = radius > 0.0
        ratio = FRICTION.area_ratio if sheared else 1.0
        axes = np.column_stack([ratio * radius, radius])[closed]
        turn = np.array([[math.cos(CAMERA), -math.sin(CAMERA)], [math.sin(CAMERA), math.cos(CAMERA)]])
        centre = self.surface.position[closed] @ turn.T + SHIFT + 0.5 * self.width
        light = {"blur": 1.5, "noise": 0.05, "gradient": (0.15, -0.1), "bits": 8}
        shown = centre / PIXEL, axes / PIXEL, CAMERA
        return picture((side, side), *shown, **light, rng=(self.seed, number, int(sheared)))


def measured(surface: mf.Surface, load: FloatArray, seed: int, model: Model) -> Series:
    """Press and shear a surface at true loads [N]; the returned forces have the errors of the instruments."""
    rng, noise = np.random.default_rng(seed), MeasurementErrors()
    law = replace(model, contact=mf.JKR(ADHESION_ENERGY))
    true = surface.replaced(material=MATERIAL, friction=FRICTION)
    area = np.array([mf.equilibrium(true, law, load=each).asperity_area for each in load.tolist()])
    force = FRICTION.shear_strength * FRICTION.area_ratio * area.sum(axis=1)
    found = load + noise.of_load(load) * rng.standard_normal(load.shape)
    friction = force + noise.of_friction_force(force) * rng.standard_normal(load.shape)
    width = float(np.ptp(surface.position, axis=0).max()) + 2.0  # 1 mm around the outermost sites
    return Series(true, found, friction, area, width, seed)


def calibration_tests() -> list[Series]:
    """Return three tests of a sample of five caps of one height, up to contact radii of .4 mm on each cap."""
    # the loads of five contacts of these radii under Hertz's law; .4 mm is the largest of the paper
    radius = np.linspace(0.08, 0.4, 10)
    load = 5.0 * 4.0 / 3.0 * MATERIAL.composite_modulus * radius**3 / RADIUS
    sample = mf.Surface(FIVE, np.full(5, 0.15), RADIUS, MATERIAL, FRICTION, BLOCK)
    return [measured(sample, load, seed, mf.Independent()) for seed in (1, 2, 3)]


def part_test(design: mf.Design) -> Series:
    """Return the measurement of the made part of a design: heights scaled, with random errors, and tilted."""
    surface = design.surface
    lowest = mf.equilibrium(surface, separation=float(surface.height.min())).load
    part = surface.replaced(height=SCALE * surface.height).perturbed(HEIGHT_SD, rng=7).tilted(TILT, 0.0)
    return measured(part, LOADS * lowest, 20, design.law.model)


# The specification of a surface without its material.
WANTED = Path(__file__).with_name("wanted.toml")


@click.command(help=__doc__.split("\n\n")[1])
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--part", type=click.Path(path_type=Path, exists=True), help="Result folder of the part's design."
)
def main(folder: Path, part: Path | None) -> None:
    """Write the raw data."""
    if part is None:
        write(folder / "sample", calibration_tests())
        shutil.copyfile(WANTED, folder / "wanted.toml")
        click.echo(f"wrote {folder / 'sample'} and {folder / 'wanted.toml'}")
        return
    write(folder / "part", [part_test(mf.load(part))])
    click.echo(f"wrote {folder / 'part'}")


def write(folder: Path, tests: list[Series]) -> None:
    """Write tests as TIFF files, with pixels of 10 um, and a table of the forces."""
    import tifffile

    folder.mkdir(parents=True, exist_ok=True)
    rows = ["image,sheared_image,test,load_mN,friction_force_mN"]
    for number, test in enumerate(tests, 1):
        for k, (load, force) in enumerate(zip(test.load, test.friction_force, strict=True), 1):
            names = [f"test{number}_{k}{state}.tif" for state in ("", "_sheared")]
            for name, sheared in zip(names, (False, True), strict=True):
                tifffile.imwrite(folder / name, test.image(k - 1, sheared), compression="zlib")
            rows.append(f"{names[0]},{names[1]},test {number},{1e3 * load:.2f},{1e3 * force:.2f}")
    (folder / "forces.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
