"""Calibrations from the measured tables, with the options of `metafem calibrate`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.cli.measurement.quantities import names_of, quantities
from metafem.cli.study.options import option_name
from metafem.cli.terminal import loaded
from metafem.errors import InvalidInput, named, refuse_if

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit
    from metafem.files import CalibrationData
    from metafem.surface import Surface

# Member of MeasurementErrors for each option of a standard deviation.
MEMBERS = {
    "load_error": "load",
    "boundary_error": "boundary",
    "friction_error": "friction_force",
    "friction_relative_error": "friction_relative",
}

# Options of the standard deviations: unit, example and help text.
ERRORS = {
    "load_error": ("N", "5 mN", "Standard deviation of a load. Default: {}."),
    "boundary_error": (
        "mm",
        "1.4 um",
        "Standard deviation of the boundary of a contact. Default: {}, or that of the tables of images.",
    ),
    "friction_error": ("N", "1 mN", "Standard deviation of a friction force at zero. Default: {}."),
    "friction_relative_error": (
        "%",
        "1 %",
        "Standard deviation of a friction force in proportion to it. Default: {}.",
    ),
}

# Options of the dimensions of a sample: unit, example and help text.
LENGTHS = {
    "radius": ("mm", "526 um", 'Radius of the caps, such as "{}"; needed for E*.'),
    "radius_sd": ("mm", "5 um", 'Its standard deviation, such as "{}". Default: 0.'),
    "thickness": (
        "mm",
        "7.2 mm",
        'Thickness of the sample\'s block, such as "{}", for --model layer or block.',
    ),
    "width": ("mm", "20 mm", 'Width of that block along x, such as "{}", for --model block.'),
    "length": ("mm", "20 mm", 'Length of that block along y, such as "{}", for --model block.'),
}

# Names of the options of a part in full contact; all of them are needed.
FULL = ("full_contact", "part", "load_min")


@dataclass(frozen=True)
class Fits:
    """The calibrations from measured tables, with the options of the command; `sources` names the files."""

    measured: CalibrationData
    options: Mapping[str, Any]
    sources: list[str]

    @cached_property
    def names(self) -> Names:
        """How errors name the options, and the units in which these were written."""
        return names_of(self.options, (*LENGTHS, "contacts", "poisson_ratio", "bootstrap", "load_min"))

    @cached_property
    def errors(self) -> mf.calibration.MeasurementErrors:
        """Standard deviations from the options, else from tables of images, else from the source paper."""
        given = {} if self.measured.boundary is None else {"boundary": self.measured.boundary}
        for name, value in quantities(ERRORS, self.options).items():
            if value is not None:
                given[MEMBERS[name]] = value
        texts = {member: self.options[name] for name, member in MEMBERS.items()}
        names = {member: option_name(name) for name, member in MEMBERS.items()}
        with named(replace(mf.files.option_names(texts), names=names)):
            return mf.calibration.MeasurementErrors(**given)

    @cached_property
    def contact(self) -> ContactCalibration | None:
        """The calibration of E* and the adhesion energy; None without compression tests."""
        points, options = self.measured.compression, self.options
        if points is None:
            return None
        example = '--radius "526 um" --radius-sd "5 um"'
        lengths, common = quantities(LENGTHS, options), self._common(points)
        radius, count, single = lengths["radius"], options["contacts"], points.contacts
        if radius is None:
            raise InvalidInput(f"E* needs the radius of the caps; add for example {example}")
        must = f"the tables hold {single} contacts one by one; leave it out"
        refuse_if(single is not None and count not in (None, single), f"--contacts {count}: {must}")
        with mf.files.of_tables(replace(self.names, places=points.place), self.sources):
            sample = mf.calibration.Sample(
                contacts=single or count or 1,
                radius_sd=lengths["radius_sd"] or 0.0,
                poisson_ratio=options["poisson_ratio"],
                model=mf.files.chosen_model(mf.Independent(), options["model"], options["contact"]),
                surface=self._surface(lengths),
            )
            return mf.calibration.fit_compression(
                points.load, points.area, radius, sample, robust=options["robust"], **common
            )

    @cached_property
    def shear(self) -> ShearCalibration | None:
        """The calibration of B and sigma; None without shear tests."""
        points = self.measured.shear
        if points is None:
            return None
        with mf.files.of_tables(replace(self.names, places=points.place), self.sources):
            return mf.calibration.shear(
                points.area_before, points.area_sheared, points.friction_force, **self._common(points)
            )

    def _common(self, points: Any) -> dict[str, Any]:
        """Return the arguments that the fits of compression and shear share."""
        count, seed = self.options["bootstrap"], self.options["seed"]
        bootstrap = None if count is None else mf.calibration.Bootstrap(count, seed)
        return {"errors": self.errors, "test": points.test, "bootstrap": bootstrap}

    def _surface(self, lengths: Mapping[str, Any]) -> Surface | None:
        """Return the surface of the sample, which a model needs; None without --model.

        The positions of its caps are those of --sample or, by default, of the contacts in the images.
        """
        options, model = self.options, self.options["model"]
        if model is None:
            for name in ("sample", "thickness", "width", "length"):
                needs = f"{option_name(name)} needs --model, such as --model layer"
                refuse_if(options[name] is not None, needs)
            return None
        ratio = 0.5 if options["poisson_ratio"] is None else options["poisson_ratio"]
        material = mf.Material(1.0, ratio)  # a placeholder: the modulus is fitted
        radius, _, thickness, width, length = lengths.values()
        position = self.measured.position
        if options["sample"] is not None:
            surface = mf.files.read_surface(options["sample"], material, radius)
        elif position is not None:
            surface = mf.Surface(position, np.zeros(len(position)), radius, material)
        else:
            raise InvalidInput(
                "--model needs the positions of the caps; add a table of them, --sample heights.csv, or "
                "calibrate with a table of metafem images"
            )
        if thickness is not None:
            # a layer has no sides: without width and length, any block that contains the caps serves
            extent = np.ptp(surface.position, axis=0) + 2.0 * radius
            sides = extent if width is None or length is None else (width, length)
            surface = surface.replaced(block=mf.Block(float(sides[0]), float(sides[1]), thickness))
        unknown = model in ("layer", "block") and surface.block is None
        refuse_if(unknown, f'--model {model} needs --thickness, such as --thickness "7.2 mm"')
        unknown = model == "block" and (width is None or length is None)
        refuse_if(unknown, '--model block needs --width and --length, such as --width "20 mm"')
        return surface

    @cached_property
    def strength(self) -> StrengthFit | None:
        """The fit of sigma to a part in full contact; None without the options of such a part.

        E* and B are those of the other calibrations or, without them, of the part's result folder.
        """
        options, contact, shear = self.options, self.contact, self.shear
        missing = [option_name(name) for name in FULL if options[name] is None]
        if len(missing) == len(FULL):
            return None
        example = '--full-contact measured.csv --part linear --load-min "0.5 N"'
        refuse_if(missing, f"{' and '.join(missing)} must be given too, as in {example}")
        design = loaded(options["part"])
        surface = design.surface
        if contact is not None:
            surface = surface.replaced(material=contact.material)
        if shear is not None:
            surface = surface.replaced(friction=shear.friction)
        unknown = f"the part of {options['part']} has no friction; add a shear test"
        refuse_if(surface.friction is None, f"the area ratio B is not known: {unknown}")
        law = mf.files.read_measured_law(
            options["full_contact"], surface.material, surface.friction, errors=self.errors
        )
        calibrations = [each for each in (contact, shear) if each is not None]
        known: dict[str, Any] = {}
        if calibrations:
            names, covariance = mf.calibration.joint_covariance(*calibrations)
            known = {"covariance": covariance, "parameters": names}
        with named(self.names):
            least = mf.files.quantity("--load-min", options["load_min"], "N", "0.5 N")
            return mf.calibration.shear_strength(law, surface, least, model=design.law.model, **known)
