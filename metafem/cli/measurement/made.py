"""Output of `metafem topography`: the made surface, its errors and its law."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from metafem.cli.terminal import notes_data, print_notes, print_table, say, terminal

if TYPE_CHECKING:
    from rich.console import Console

    from metafem.calibration import MadeSurface
    from metafem.inversion import Design
    from metafem.prediction import FrictionLaw

# Number of loads at which the two laws are printed.
LOADS = 5

UM = 1e3

# Decimals to which a mean is rounded. The alignment makes the mean position errors 0 up to rounding errors,
# which are not printed.
DIGITS = 6


def print_made(design: Design, made: MadeSurface, law: FrictionLaw) -> None:
    """Print the errors of the part and both friction laws."""
    console = terminal()
    found = f"{made.surface.count} of {made.design.count} asperities measured"
    say(console, f"{found}, roughness (s.d.) {UM * made.roughness:.2g} um")
    _print_errors(console, made)
    areas = list(zip(law.load, design.law.area, law.area, strict=True))
    every = max(1, len(areas) // LOADS)
    rows = [
        (
            *(f"{value:.4g}" for value in row),
            f"{100.0 * (row[2] / row[1] - 1.0):+.2g} %" if row[1] > 0.0 else "-",
        )
        for row in areas[max(0, len(areas) // LOADS - 1) :: every]
    ]
    print_table(console, ["load [N]", "designed area [mm²]", "made [mm²]", "change"], rows)
    touching = design.law.area > 0.0
    change = 100.0 * _rms(law.area[touching] / design.law.area[touching] - 1.0)
    differs = f"{change:.2g} % (root mean square over the loads)"
    say(console, f"law of the made surface: A0 differs from that of the design by {differs}")
    print_notes(console, dict.fromkeys(made.notes))


def _print_errors(console: Console, made: MadeSurface) -> None:
    """Print mean, standard deviation and largest value of the errors of heights, radii and positions."""
    x, y = UM * made.position_error.T
    sd = UM * made.position_sd
    relative = 100.0 / made.design.radius[made.site]
    rows = [
        (
            name,
            f"{round(float(values.mean()), DIGITS) + 0.0:+.2g} {unit}",
            f"{values.std():.2g} {unit}",
            f"{values[abs(values).argmax()]:+.2g} {unit}",
            f"{_rms(error):.2g} {unit}",
        )
        for name, values, error, unit in (
            ("height", UM * made.height_error, UM * made.height_sd, "um"),
            ("radius", relative * made.radius_error, 100.0 * made.radius_sd / made.surface.radius, "%"),
            ("x", x, sd, "um"),
            ("y", y, sd, "um"),
        )
    ]
    print_table(console, ["made minus designed", "mean", "s.d.", "largest", "standard error"], rows)


def _rms(values: Any) -> float:
    return math.sqrt(float((values**2).mean()))


def made_data(design: Design, made: MadeSurface, law: FrictionLaw) -> dict[str, Any]:
    """Return the made surface, and its friction law, for JSON."""
    level = made.levelling
    return {
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
        "notes": notes_data(made.notes),
    }
