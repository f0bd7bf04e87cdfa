"""The command compare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.options import (
    Name,
    column_option,
    columns_of,
    command,
    force_option,
    json_option,
    option_name,
    quantities,
)
from metafem.cli.output import show
from metafem.cli.progress import loaded, progress
from metafem.cli.study import deviation_option, given_deviations, show_study
from metafem.errors import refuse_if

if TYPE_CHECKING:
    from metafem._validate import FloatArray
    from metafem.calibration import MeasuredLaw
    from metafem.inversion import Design
    from metafem.surface import Friction, Material, Surface

# Parameters of the part whose errors shift all points together: unit and example of each.
PARAMETERS = {
    "composite_modulus": ("MPa", "0.04MPa"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
}

# Options of the material pair: unit, example and help text.
DESIGNED = "Default: that of the calibration or of the design."
PAIR = {
    "composite_modulus": ("MPa", "1.36 MPa", f"E* of the part, such as {{}}. {DESIGNED}"),
    "shear_strength": ("MPa", "0.404 MPa", f"σ of static friction, such as {{}}. {DESIGNED}"),
    "area_ratio": ("1", "0.85", f"B of static friction. {DESIGNED}"),
    "sliding_shear_strength": ("MPa", "0.37 MPa", "σ of sliding friction. Default: that of static friction."),
    "sliding_area_ratio": ("1", "0.85", "B of sliding friction. Default: that of static friction."),
}

# Options of the expected errors of a part: unit, example and help text.
EXPECTED = {
    f"{name}_sd": (unit, example, f"{meaning}, as a standard deviation; 0 leaves it out. Default: {{}}.")
    for name, unit, example, meaning in (
        ("angle", "rad", "0.05deg", "Expected tilt about either axis"),
        ("height_scale", "%", "2%", "Expected error of the scale of all heights"),
        ("composite_modulus", "%", "5%", "Expected error of E*"),
        ("friction", "%", "5%", "Expected error of σB"),
        ("height", "mm", "0.9um", "Expected error of each height"),
    )
}


@dataclass(frozen=True, eq=False)
class Pair:
    """The material pair of a part, and the covariance of its parameters."""

    material: Material
    friction: dict[str, Friction | None]  # by the label of the law
    parameters: tuple[str, ...]
    covariance: FloatArray

    def errors(self, law: MeasuredLaw) -> dict[str, Any]:
        """Return the arguments of `compare` for the errors; areas without a friction depend on E* alone."""
        import numpy as np

        of_law = [law.friction is not None or name == "composite_modulus" for name in self.parameters]
        kept = [i for i, used in enumerate(of_law) if used]
        names = [self.parameters[i] for i in kept]
        return {"parameters": names, "covariance": self.covariance[np.ix_(kept, kept)]} if kept else {}


@command(
    click.argument("folder", type=Name(), metavar="DIR"),
    click.argument("table", type=Name(), metavar="MEASURED.csv"),
    click.option(
        "--sliding",
        type=Name(),
        metavar="TABLE.csv",
        help="Table of the sliding friction law, to be compared beside the static one.",
    ),
    column_option,
    click.option(
        "--calibration",
        type=Name(),
        metavar="FILE.toml",
        help="E*, σ and B of the part with their errors and correlations, from metafem calibrate.",
    ),
    *quantities(PAIR),
    deviation_option(PARAMETERS),
    click.option("--explain", is_flag=True, help="State which errors of the part explain the difference."),
    *quantities(EXPECTED),
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
    sigma B. The fit starts from the E*, sigma and B of the comparison. Options such as --friction-sd state
    how large each error is expected to be.

    The results are written to DIR/measured.nc and DIR/explained.nc, and `metafem report DIR` adds them to the
    report.

    Example: metafem compare linear measured.csv --calibration calibration.toml --explain
    """
    from metafem.studies.measured import answers, explained, features, measured
    from metafem.studies.summary import summary

    expected = {name: given[name] for name in EXPECTED if given[name] is not None}
    refuse_if(expected and not explain, f"{option_name(next(iter(expected), ''))} needs --explain")
    with progress():
        design = loaded(folder)
        pair = _pair(design.surface, given, given_deviations(given["sd"], PARAMETERS))
        paths = {"static": table, "sliding": given["sliding"]}
        laws = _laws(design, pair, paths, columns_of(given["column"]))
        files = [
            mf.files.study_path(folder, name, force) for name in ("measured", "explained")[: 1 + explain]
        ]
        comparisons = [mf.calibration.compare(law, design, **pair.errors(law)) for law in laws]
        studies = [measured(comparisons, design.law.model)]
        if explain:
            priors = {name.removesuffix("_sd"): value for name, value in expected.items()} or None
            studies.append(explained(mf.calibration.explain(laws[0], design, expected=priors)))
        # all files are written at the end, so that a stopped run leaves none that a repeated run would refuse
        for study, path in zip(studies, files, strict=True):
            mf.files.write_study(study, path, force=force)
    said = [answers(studies[0]), *([summary(study).answer] for study in studies[1:])]
    if as_json:
        data = [
            {"file": str(path), "answers": lines, **mf.files.study_data(study)}
            for study, path, lines in zip(studies, files, said, strict=True)
        ]
        show(True, {**data[0], **({"explanation": data[1]} if explain else {})})
        return
    more = features(studies[0])
    tables = [[(more.columns, more.rows, more.title)] if more.rows else [], []]
    for study, path, lines, others in zip(studies, files, said, tables, strict=False):
        show_study(False, {}, study, path, *others, lines=lines)


def _pair(surface: Surface, given: Mapping[str, Any], deviations: Mapping[str, float]) -> Pair:
    """Return the material pair from the options, else from the calibration, else from the design."""
    import numpy as np

    found = None if given["calibration"] is None else mf.files.read_parameters(given["calibration"])
    values = {} if found is None else dict(zip(found.parameters, found.value.tolist(), strict=True))
    values |= {name: given[name] for name in PARAMETERS if given[name] is not None}
    modulus = values.get("composite_modulus", surface.material.composite_modulus)
    static = _friction(values, surface.friction, "")
    sliding = {name: given[f"sliding_{name}"] for name in ("shear_strength", "area_ratio")}
    friction = {"static": static, "sliding": _friction(sliding, static, "sliding-")}
    names, covariance = tuple(deviations), np.diag(np.square([*deviations.values()]))
    if found is not None:
        for name in found.parameters:
            must = f"--sd {name} and --calibration both give the error of {name}; keep one"
            refuse_if(name in deviations, must)
        # the calibration's error does not apply to a value that an option states
        used = [i for i, name in enumerate(found.parameters) if name in PARAMETERS and given[name] is None]
        apart = np.zeros((len(used), len(names)))
        covariance = np.block([[found.covariance[np.ix_(used, used)], apart], [apart.T, covariance]])
        names = (*(found.parameters[i] for i in used), *names)
    material = mf.Material(modulus, surface.material.poisson_ratio)
    return Pair(material, friction, names, covariance)


def _friction(given: Mapping[str, Any], default: Friction | None, kind: str) -> Friction | None:
    """Return the Friction with the given values; `default` supplies what they do not state."""
    strength, ratio = given.get("shear_strength"), given.get("area_ratio")
    if strength is None and ratio is None:
        return default
    needs = f"--{kind}area-ratio needs --{kind}shear-strength, which the design does not state"
    refuse_if(strength is None and default is None, needs)
    before = default or mf.Friction(1.0, 1.0)
    strength = before.shear_strength if strength is None else strength
    try:
        return mf.Friction(strength, before.area_ratio if ratio is None else ratio)
    except mf.InvalidInput as error:
        raise error.at(f"{kind.replace('-', '_')}{error.key}") from None


def _laws(
    design: Design, pair: Pair, paths: Mapping[str, Path | None], columns: Mapping[str, str]
) -> list[MeasuredLaw]:
    """Return the measured laws in tables, by their labels."""
    return [
        mf.files.read_measured_law(
            mf.files.read_table(path, columns),
            pair.material,
            pair.friction[label],
            label=label,
            sites=design.sites,
        )
        for label, path in paths.items()
        if path is not None
    ]
