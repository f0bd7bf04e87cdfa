"""Output of `metafem topography`: the made surface, its systematic errors and its law."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.cli.terminal import notes_data, print_notes, print_table, say, terminal

if TYPE_CHECKING:
    from rich.console import Console

    from metafem.calibration import Correction, MadeSurface
    from metafem.inversion import Design
    from metafem.prediction import FrictionLaw

# Number of printed asperities, those with the largest height errors, and of loads of the two laws.
WORST, LOADS = 5, 5

# The printed terms of the systematic error: unit, and its number in one unit of the package.
TERMS = {
    "offset": ("um", 1e3),
    "scale": ("% of the height above or below the mean of {mean:.4g} um", 1e2),
    "tilt_x": ("um/mm along x", 1e3),
    "tilt_y": ("um/mm along y", 1e3),
    "bow_xx": ("um/mm^2 along x", 1e3),
    "bow_xy": ("um/mm^2 along x and y", 1e3),
    "bow_yy": ("um/mm^2 along y", 1e3),
}

UM = 1e3

# Digits of a mean: by the alignment, the means of the positions are 0 up to rounding.
DIGITS = 6


def print_made(design: Design, made: MadeSurface, correction: Correction | None, law: FrictionLaw) -> None:
    """Print the errors of the part, the worst asperities, the systematic errors and the two laws."""
    console = terminal()

    error = UM * made.height_error
    radius = made.radius_error / made.design.radius[made.site]
    place = UM * made.position_error
    found = f"{made.surface.count} of {made.design.count} asperities measured"
    say(console, f"{found}, roughness (s.d.) {UM * made.roughness:.2g} um")
    rows: list[tuple[str, ...]] = [
        ("height", *_moments(error, "um"), f"{UM * _rms(made.height_sd):.2g} um"),
        (
            "radius",
            *_moments(100.0 * radius, "%"),
            f"{100.0 * _rms(made.radius_sd / made.surface.radius):.2g} %",
        ),
        ("x", *_moments(place[:, 0], "um"), f"{UM * _rms(made.position_sd):.2g} um"),
        ("y", *_moments(place[:, 1], "um"), f"{UM * _rms(made.position_sd):.2g} um"),
    ]
    print_table(console, ["made minus designed", "mean", "s.d.", "largest", "standard error"], rows)
    worst = np.argsort(-np.abs(error))[:WORST]
    sites = design.sites[made.site]
    rows = [
        (
            str(sites[i]),
            *(f"{value:.3f}" for value in made.design.position[made.site[i]]),
            f"{UM * made.design.height[made.site[i]]:.2f}",
            f"{UM * made.surface.height[i]:.2f}",
            f"{error[i]:+.2f}",
            f"{UM * made.height_sd[i]:.2f}",
        )
        for i in worst
    ]
    titles = ["site", "x [mm]", "y [mm]", "designed height [um]", "made [um]", "error [um]", "s.e. [um]"]
    print_table(console, titles, rows, "largest height errors")
    if correction is not None:
        _print_correction(console, correction, UM * float(made.design.height[made.site].mean()))
    first, every = (
        design.law,
        range(len(law.load) // LOADS - 1, len(law.load), max(1, len(law.load) // LOADS)),
    )
    rows = [
        (
            f"{law.load[i]:.4g}",
            f"{first.area[i]:.4g}",
            f"{law.area[i]:.4g}",
            _change(first.area[i], law.area[i]),
        )
        for i in every
    ]
    print_table(console, ["load [N]", "designed area [mm²]", "made [mm²]", "change"], rows)
    change = _changes(first, law)
    differs = f"{100.0 * _rms(change):.2g} % (root mean square over the loads)"
    say(console, f"law of the made surface: A0 differs from that of the design by {differs}")
    notes = dict.fromkeys((*made.notes, *(() if correction is None else correction.notes)))
    print_notes(console, notes)


def _print_correction(console: Console, correction: Correction, mean: float) -> None:
    """Print the errors; `mean` is the mean designed height [um], the reference of the scale."""
    for name, value, sd in zip(
        correction.terms, correction.value.tolist(), correction.value_sd.tolist(), strict=True
    ):
        unit, size = TERMS[name]
        term = f"systematic height error, {name.replace('_', ' ')}:"
        what = "mean height error" if name == "offset" else term
        say(console, f"{what} {size * value:+.3g} ± {size * sd:.2g} {unit.format(mean=mean)}")
    if not correction.terms:
        say(console, "no systematic height error is significant")
    say(
        console,
        f"random height errors, which cannot be corrected: {UM * correction.random_sd:.2g} um (s.d.); height "
        f"error (root mean square) {UM * correction.error:.3g} um here, "
        f"{UM * correction.expected_error:.3g} um expected with corrected heights",
    )


def _moments(values: Any, unit: str) -> tuple[str, str, str]:
    return (
        f"{round(float(values.mean()), DIGITS) + 0.0:+.2g} {unit}",
        f"{values.std():.2g} {unit}",
        f"{values[abs(values).argmax()]:+.2g} {unit}",
    )


def _rms(values: Any) -> float:
    return math.sqrt(float((values**2).mean()))


def _change(one: float, other: float) -> str:
    return f"{100.0 * (other / one - 1.0):+.2g} %" if one > 0.0 else "-"


def _changes(designed: FrictionLaw, made: FrictionLaw) -> Any:
    """Return the relative changes of A0 at loads with contacts in the design."""
    touching = designed.area > 0.0
    return made.area[touching] / designed.area[touching] - 1.0


def made_data(
    design: Design, made: MadeSurface, correction: Correction | None, law: FrictionLaw
) -> dict[str, Any]:
    """Return the made surface, its correction and its law for JSON."""
    level = made.levelling
    data: dict[str, Any] = {
        "site": design.sites[made.site].tolist(),
        "missing": design.sites[made.missing].tolist(),
        "x_mm": made.surface.position[:, 0].tolist(),
        "y_mm": made.surface.position[:, 1].tolist(),
        "height_mm": made.surface.height.tolist(),
        "radius_mm": made.surface.radius.tolist(),
        "sd_position_mm": made.position_sd.tolist(),
        "sd_height_mm": made.height_sd.tolist(),
        "sd_radius_mm": made.radius_sd.tolist(),
        "height_error_mm": made.height_error.tolist(),
        "roughness_mm": made.roughness,
        "rotation_rad": made.rotation,
        "mirrored": made.mirrored,
        "tilt_rad": level.tilt.tolist(),
        "bow_per_mm": level.bow.tolist(),
        "load_N": law.load.tolist(),
        "designed_area_mm2": design.law.area.tolist(),
        "made_area_mm2": law.area.tolist(),
        "notes": notes_data((*made.notes, *(() if correction is None else correction.notes))),
    }
    if correction is not None:
        terms = zip(correction.terms, correction.value.tolist(), correction.value_sd.tolist(), strict=True)
        data["correction"] = {
            "terms": {name: {"value": value, "sd": sd} for name, value, sd in terms},
            "random_sd_mm": correction.random_sd,
            "error_mm": correction.error,
            "expected_error_mm": correction.expected_error,
            "spread_mm": correction.spread,
            "expected_spread_mm": correction.expected_spread,
            "height_mm": correction.surface.height.tolist(),
        }
    return data
