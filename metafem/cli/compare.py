"""The command compare."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem.cli.options import (
    Name,
    column_option,
    columns_of,
    command,
    file_option,
    force_option,
    json_option,
    quantity,
)
from metafem.cli.output import progress
from metafem.cli.study import show_study


@command(
    click.argument("folder", type=Name(), metavar="DIR"),
    click.argument("table", type=Name(), metavar="MEASURED.csv"),
    column_option,
    file_option("--calibration", "FILE.toml", "E*, σ and B of the part with their errors and correlations."),
    quantity("shear_strength", "MPa", "0.404 MPa", "σ, such as {}. Default: that of calibration or design."),
    click.option("--explain", is_flag=True, help="State which errors of the part explain the difference."),
    force_option,
    json_option,
    short_help="Compare a measured friction law with the design of a folder.",
)
def compare(folder: Path, table: Path, explain: bool, force: bool, as_json: bool, **given: Any) -> None:
    """Compare the law in MEASURED.csv with the law of the design in the result folder DIR.

    One line of the table names its columns with their units: load_mN,friction_force_mN or
    load_mN,area_mm2. The columns load_sd_mN, friction_force_sd_mN and area_sd_mm2 are optional. Without them,
    the standard deviations are 5 mN for loads, 1 mN + 1 % for friction forces, and 1.4 um of the contacts'
    boundary for areas. Tables of `metafem images` are also read.

    With --explain, errors of the part that explain the difference are fitted: tilt, height scale, E* and
    sigma B. The fit starts from the E*, sigma and B of the comparison.

    The results are written to DIR/measured.nc and DIR/explained.nc, and `metafem report DIR` adds them to the
    report.

    Example: metafem compare linear measured.csv --calibration calibration.toml --explain
    """
    from metafem.calibration.comparison import PARAMETERS
    from metafem.studies.measured import explained, measured

    with progress():
        design = mf.load(folder)
        surface, strength, calibration = design.surface, given["shear_strength"], given["calibration"]
        stated, errors = {} if strength is None else {"shear_strength": strength}, dict[str, Any]()
        if calibration is not None:
            # the calibration's error does not apply to a value that an option states
            names, value, covariance = mf.files.read_parameters(calibration, {*PARAMETERS} - stated.keys())
            errors = {"parameters": names, "covariance": covariance}
            stated |= dict(zip(names, value.tolist(), strict=True))
        modulus = stated.pop("composite_modulus", surface.material.composite_modulus)
        material = mf.Material(modulus, surface.material.poisson_ratio)
        designed = {} if surface.friction is None else asdict(surface.friction)
        friction = mf.Friction(**designed | stated) if stated else surface.friction
        read = mf.files.read_table(table, columns_of(given["column"]))
        law = mf.files.read_measured_law(read, material, friction, sites=design.sites)
        wanted = ("measured", "explained")[: 1 + explain]
        files = [mf.files.study_path(folder, name, force) for name in wanted]
        comparison = mf.calibration.compare(law, design, **errors)
        studies = [measured(comparison, design.law.model)]
        if explain:
            studies.append(explained(mf.calibration.explain(law, design)))
        # all files are written at the end, so that a stopped run leaves none that a repeated run would refuse
        for study, path in zip(studies, files, strict=True):
            mf.files.write_study(study, path, force=force)
    show_study(as_json, *zip(studies, files, strict=True))
