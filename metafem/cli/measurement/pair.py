"""The material pair of a measured part, from options, a calibration or the design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.cli.group import Name
from metafem.cli.measurement.quantities import names_of
from metafem.cli.study.options import option_name, with_options
from metafem.cli.study.parameters import deviation_option
from metafem.errors import named, refuse_if

if TYPE_CHECKING:
    from metafem._validate import FloatArray, IntArray
    from metafem.calibration import MeasuredLaw
    from metafem.surface import Friction, Material, Surface

# Parameters of the part whose errors shift all points together: unit and example of each.
PARAMETERS = {
    "composite_modulus": ("MPa", "0.04MPa"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
}

# Meaning and default of the options of the material pair.
DESIGNED = "that of the calibration or of the design"
PAIR = {
    "composite_modulus": ('E* of the part, such as "1.36 MPa"', DESIGNED),
    "shear_strength": ('σ of static friction, such as "0.404 MPa"', DESIGNED),
    "area_ratio": ("B of static friction", DESIGNED),
    "sliding_shear_strength": ("σ of sliding friction", "that of static friction"),
    "sliding_area_ratio": ("B of sliding friction", "that of static friction"),
}

pair_options = with_options(
    click.option(
        "--calibration",
        type=Name(),
        metavar="FILE.json",
        help="E*, σ and B of the part with their errors and correlations, from metafem calibrate.",
    ),
    *(
        click.option(
            option_name(name),
            type=float if name.endswith("ratio") else str,
            metavar="NUMBER" if name.endswith("ratio") else "STRESS",
            help=f"{meaning}. Default: {default}.",
        )
        for name, (meaning, default) in PAIR.items()
    ),
    deviation_option(PARAMETERS),
)


@dataclass(frozen=True, eq=False)
class Pair:
    """The material pair of a part, and the covariance of its parameters."""

    material: Material
    static: Friction | None
    sliding: Friction | None
    parameters: tuple[str, ...]
    covariance: FloatArray

    def errors(self, law: MeasuredLaw) -> dict[str, Any]:
        """Return the arguments of `compare` for the errors of the parameters.

        A law without a Friction consists of areas, which depend only on E*.
        """
        kept = [
            i
            for i, name in enumerate(self.parameters)
            if law.friction is not None or name == "composite_modulus"
        ]
        if not kept:
            return {}
        names = [self.parameters[i] for i in kept]
        return {"parameters": names, "covariance": self.covariance[np.ix_(kept, kept)]}


def pair_of(surface: Surface, given: Mapping[str, Any], deviations: Mapping[str, float]) -> Pair:
    """Return the material pair from the options, else from the calibration, else from the design."""
    found = None if given["calibration"] is None else mf.files.read_parameters(given["calibration"])
    values = {} if found is None else dict(zip(found.parameters, found.value.tolist(), strict=True))
    with named(names_of({name: given[name] for name in PAIR})):
        modulus = values.get("composite_modulus", surface.material.composite_modulus)
        if given["composite_modulus"] is not None:
            modulus = mf.files.quantity("--composite-modulus", given["composite_modulus"], "MPa")
        friction = surface.friction
        if "shear_strength" in values:
            friction = mf.Friction(values["shear_strength"], values.get("area_ratio", 1.0))
        static = _friction(given, "", friction)
        sliding = _friction(given, "sliding_", static)
        material = mf.Material(modulus, surface.material.poisson_ratio)
    names, covariance = tuple(deviations), np.diag(np.square([*deviations.values()]))
    if found is not None:
        for name in found.parameters:
            must = f"--sd {name} and --calibration both give the error of {name}; keep one"
            refuse_if(name in deviations, must)
        # the calibration's error does not apply to a value that an option states
        used = [i for i, name in enumerate(found.parameters) if name in PARAMETERS and given[name] is None]
        apart = np.zeros((len(used), len(names)))
        known = found.covariance[np.ix_(used, used)]
        names = (*(found.parameters[i] for i in used), *names)
        covariance = np.block([[known, apart], [apart.T, covariance]])
    return Pair(material, static, sliding, names, covariance)


def measured_laws(pair: Pair, table: Path, sliding: Path | None, sites: IntArray) -> list[MeasuredLaw]:
    """Return the static law in `table` and, if `sliding` names a table, the sliding law in it.

    `sites` are the sites of the design's asperities.
    """
    return [
        mf.files.read_measured_law(path, pair.material, friction, label=label, sites=sites)
        for label, path, friction in (("static", table, pair.static), ("sliding", sliding, pair.sliding))
        if path is not None
    ]


def _friction(given: Mapping[str, Any], kind: str, default: mf.Friction | None) -> mf.Friction | None:
    """Return the Friction that the options of a kind state; `default` supplies what they do not state.

    `kind` is "" for static and "sliding_" for sliding friction.
    """
    stress, ratio = given[f"{kind}shear_strength"], given[f"{kind}area_ratio"]
    names = {name: option_name(kind + name) for name in ("shear_strength", "area_ratio")}
    if stress is None and ratio is None:
        return default
    needs = f"{names['area_ratio']} needs {names['shear_strength']}, which the design does not state"
    refuse_if(stress is None and default is None, needs)
    before = default or mf.Friction(1.0, 1.0)
    strength = before.shear_strength
    if stress is not None:
        strength = mf.files.quantity(names["shear_strength"], stress, "MPa")
    with named(Names(names, {"shear_strength": ("MPa", 1.0)})):
        return mf.Friction(strength, before.area_ratio if ratio is None else ratio)
