"""Time and memory of a stack of images, and scatter of the areas against noise, blur and radius."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import metafem as mf
from metafem.calibration import stack_areas
from validation.calibration.image_areas import errors
from validation.check import rms
from validation.scenes.pictures import picture
from validation.timing import Row, Spent, peak_memory, spent

# Images of a stack, rows and columns of each, and contacts along each side.
IMAGES, SHAPE, SIDE = 100, (2048, 2048), 8

# Largest radius of a contact [pixels]; pictures that are drawn, each of which is used several times.
LARGEST, DRAWN = 80.0, 10

# Radii [pixels], noise over the contrast and blur [pixels] at which the reported errors are compared.
GRID = [(r, n, b) for r in (8.0, 16.0, 40.0) for n in (0.02, 0.1) for b in (1.0, 2.5) if r > 5.0 * b]


def drawn(step: int) -> Any:
    """Draw the contacts of one load: the radii differ, and the smallest are open at small loads."""
    pitch = SHAPE[0] / SIDE
    x, y = np.meshgrid(*[(np.arange(SIDE) + 0.5) * pitch] * 2)
    height = np.random.default_rng(0).uniform(0.0, 0.9, SIDE**2)
    radius = LARGEST * np.sqrt(np.maximum((step + 1.0) / DRAWN - height, 0.0))
    centre = np.stack([x.ravel(), y.ravel()], axis=1)
    shown = radius > 0.0
    light = {"noise": 0.05, "gradient": (0.2, -0.1), "vignetting": 0.1}
    return picture(SHAPE, centre[shown], radius[shown], **light, bits=8, rng=step)


def command(stack: list[Any]) -> Spent:
    """Return what `metafem images` takes for a stack on disk."""
    import tifffile

    with tempfile.TemporaryDirectory() as folder:
        file, forces = Path(folder, "stack.tif"), Path(folder, "forces.csv")
        with tifffile.TiffWriter(file) as stored:
            for image in stack:
                stored.write(image, contiguous=False, compression="zlib")
        lines = [f"{file.name}:{page},{page}" for page in range(1, IMAGES + 1)]
        forces.write_text("\n".join(["image,load_mN", *lines]) + "\n")
        arguments = ["images", file, "--pixel", "5 um", "--forces", forces, "-o", file.with_suffix(".csv")]
        return spent([sys.executable, "-m", "metafem", *map(str, arguments), "--json"])


def rows() -> Iterator[Row]:
    """Measure a stack in one process, and the reported errors over the scatter."""
    pictures = [drawn(step) for step in range(DRAWN)]
    stack = [pictures[i * DRAWN // IMAGES] for i in range(IMAGES)]
    # first, as a command inherits the peak memory of the process that starts it
    used = command(stack)
    steps: list[str] = []
    start = time.process_time()
    with mf.progress.listening(lambda step, done: steps.append(step)):
        found = stack_areas(stack, pixel_size=0.005)
    seconds = time.process_time() - start
    peak = peak_memory()
    name = f"{IMAGES} images of {SHAPE[0]}², {found[-1].count} contacts in the last"
    yield Row(f"{name}: processor time", 30.0, seconds, "s")
    yield Row(f"{name}: peak memory, with {DRAWN} drawn pictures", 1.0, peak, "GiB")
    yield Row(f"{name}: steps that were not reported", 0.0, IMAGES - len(steps))
    what = f"metafem images, TIFF stack of {IMAGES} images of {SHAPE[0]}²: elapsed time"
    yield Row(what, 30.0, used.seconds, "s")
    yield Row("the same: processor time", 30.0, used.processor, "s")
    yield Row("the same: peak memory", 1.0, used.memory, "GiB")
    for radius, noise, blur in GRID:
        area, _, sd = errors(radius, noise=noise, blur=blur)
        scene = f"radius {radius:g}, noise {noise:g}, blur {blur:g}"
        yield Row(f"{scene}: rms of error over reported error, off 1 by", 0.2, abs(rms(area / sd) - 1.0))
