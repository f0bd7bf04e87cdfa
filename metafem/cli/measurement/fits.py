"""Calibrations from the measured tables, with the options of `metafem calibrate`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import metafem as mf
from metafem._given import Names
from metafem.cli.measurement.quantities import names_of, quantities
from metafem.cli.study.options import option_name
from metafem.cli.terminal import loaded
from metafem.errors import InvalidInput, named, refuse_if
from metafem.models.model import contact_of

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit
    from metafem.files import CalibrationData

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
        return names_of(self.options, (*LENGTHS, "contacts", "poisson_ratio", "load_min"))

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
        lengths, errors = quantities(LENGTHS, options), self.errors
        radius, count, single = lengths["radius"], options["contacts"], points.contacts
        if radius is None:
            raise InvalidInput(f"E* needs the radius of the caps; add for example {example}")
        must = f"the tables hold {single} contacts one by one; leave it out"
        refuse_if(single is not None and count not in (None, single), f"--contacts {count}: {must}")
        with mf.files.of_tables(replace(self.names, places=points.place), self.sources):
            sample = mf.calibration.Sample(
                contacts=single or count or 1,
                radius_sd=lengths["radius_sd"] or 0.0,
                poisson_ratio=0.5 if options["poisson_ratio"] is None else options["poisson_ratio"],
                contact=contact_of(mf.files.chosen_model(mf.Independent(), None, options["contact"])),
                unusual=options["unusual"],
            )
            return mf.calibration.fit_compression(
                points.load, points.area, radius, sample, errors=errors, test=points.test
            )

    @cached_property
    def shear(self) -> ShearCalibration | None:
        """The calibration of B and sigma; None without shear tests."""
        points = self.measured.shear
        if points is None:
            return None
        errors = self.errors
        with mf.files.of_tables(replace(self.names, places=points.place), self.sources):
            return mf.calibration.shear(
                points.area_before,
                points.area_sheared,
                points.friction_force,
                errors=errors,
                test=points.test,
            )

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
