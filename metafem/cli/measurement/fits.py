"""Calibrations of the measured tables with the options of `metafem calibrate`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.cli.study.options import option_name
from metafem.cli.terminal import loaded
from metafem.errors import InvalidInput, named

if TYPE_CHECKING:
    from metafem.calibration import (
        ContactCalibration,
        MeasurementErrors,
        ShearCalibration,
        StrengthFit,
    )
    from metafem.files import CalibrationData
    from metafem.surface import Surface

# The options of the standard deviations: member of MeasurementErrors, unit, and help text.
ERRORS = {
    "load_error": ("load", "N", "5 mN", "of a load"),
    "boundary_error": ("boundary", "mm", "1.4 um", "of the boundary of a contact"),
    "friction_error": ("friction_force", "N", "1 mN", "of a friction force at zero"),
    "friction_relative_error": ("friction_relative", "%", "1 %", "of a friction force in proportion to it"),
}

# The dimensions of a sample, with their help texts.
LENGTHS = {
    "radius": ("526 um", "Radius of the caps, such as {}; needed for E*."),
    "radius_sd": ("5 um", "Its standard deviation, such as {}. Default: 0."),
    "thickness": ("7.2 mm", "Thickness of the sample's block, such as {}, for --model layer or block."),
    "width": ("20 mm", "Width of that block along x, such as {}, for --model block."),
    "length": ("20 mm", "Length of that block along y, such as {}, for --model block."),
}


def written_names(options: Mapping[str, Any]) -> Names:
    """Return the names of the options and the units of the entries, for errors."""
    names = mf.files.option_names({name: value for name, value in options.items() if isinstance(value, str)})
    plain = {
        name: option_name(name) for name in (*LENGTHS, "contacts", "poisson_ratio", "bootstrap", "load_min")
    }
    return replace(names, units={**names.units, "": ("", 1.0)}, names={**names.names, **plain})


def sliding_range(options: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the sliding range of the options [mm]."""
    if not options["sliding_range"]:
        return None
    low, high = (
        mf.files.quantity("--sliding-range", text, "mm", "0.1 mm") for text in options["sliding_range"]
    )
    return low, high


def errors_of(options: Mapping[str, Any], measured: CalibrationData) -> mf.calibration.MeasurementErrors:
    """Return the standard deviations of the options, of the tables of images, or of the paper."""
    given = {} if measured.boundary is None else {"boundary": measured.boundary}
    for name, (member, unit, example, _) in ERRORS.items():
        if options[name] is not None:
            given[member] = mf.files.quantity(option_name(name), options[name], unit, example)
    texts = {member: options[name] for name, (member, *_) in ERRORS.items()}
    names = {member: option_name(name) for name, (member, *_) in ERRORS.items()}
    with named(replace(mf.files.option_names(texts), names=names)):
        return mf.calibration.MeasurementErrors(**given)


def fitted_contact(
    measured: CalibrationData,
    options: Mapping[str, Any],
    errors: MeasurementErrors,
    names: Names,
    sources: list[str],
) -> ContactCalibration | None:
    """Return E* and the adhesion energy, None without compression tests."""
    points = measured.compression
    if points is None:
        return None
    if options["radius"] is None:
        raise InvalidInput(
            'E* needs the radius of the caps; add for example --radius "526 um" --radius-sd "5 um"'
        )
    radius, radius_sd = (
        0.0
        if options[name] is None
        else mf.files.quantity(option_name(name), options[name], "mm", LENGTHS[name][0])
        for name in ("radius", "radius_sd")
    )
    count = options["contacts"]
    single = points.contacts
    if single is not None and count not in (None, single):
        raise InvalidInput(f"--contacts {count}: the tables hold {single} contacts one by one; leave it out")
    try:
        with named(replace(names, places=points.place)):
            sample = mf.calibration.Sample(
                contacts=single or count or 1,
                radius_sd=radius_sd,
                poisson_ratio=options["poisson_ratio"],
                model=mf.files.chosen_model(mf.Independent(), options["model"], options["contact"]),
                surface=_surface(measured, options, radius),
            )
            return mf.calibration.fit_compression(
                points.load,
                points.area,
                radius,
                sample,
                errors=errors,
                test=points.test,
                robust=options["robust"],
                bootstrap=_bootstrap(options),
            )
    except InvalidInput as error:
        raise mf.files.of_files(error, sources) from None


def _surface(measured: CalibrationData, options: Mapping[str, Any], radius: float) -> Surface | None:
    """Return the sample under a model: that of the table of caps, or the contacts of the images."""
    if options["model"] is None:
        given = [name for name in ("sample", "thickness", "width", "length") if options[name] is not None]
        if given:
            raise InvalidInput(f"{option_name(given[0])} needs --model, such as --model layer")
        return None
    ratio = 0.5 if options["poisson_ratio"] is None else options["poisson_ratio"]
    material = mf.Material(1.0, ratio)  # the modulus is fitted
    thickness, width, length = (
        None
        if options[name] is None
        else mf.files.quantity(option_name(name), options[name], "mm", LENGTHS[name][0])
        for name in ("thickness", "width", "length")
    )
    if options["sample"] is not None:
        surface = mf.files.read_surface(options["sample"], material, radius)
    elif measured.position is not None:
        surface = mf.Surface(measured.position, np.zeros(len(measured.position)), radius, material)
    else:
        raise InvalidInput(
            "--model needs the positions of the caps; add a table of them, --sample heights.csv, or "
            "calibrate with a table of metafem images"
        )
    extent = np.ptp(surface.position, axis=0) + 2.0 * radius
    if thickness is not None:
        # the layer has no sides: this block is large enough for the caps
        sides = extent if width is None or length is None else (width, length)
        surface = surface.replaced(block=mf.Block(float(sides[0]), float(sides[1]), thickness))
    if options["model"] in ("layer", "block") and surface.block is None:
        raise InvalidInput(f'--model {options["model"]} needs --thickness, such as --thickness "7.2 mm"')
    if options["model"] == "block" and (width is None or length is None):
        raise InvalidInput('--model block needs --width and --length, such as --width "20 mm"')
    return surface


def _bootstrap(options: Mapping[str, Any]) -> mf.calibration.Bootstrap | None:
    """Return the bootstrap of the options."""
    return (
        None
        if options["bootstrap"] is None
        else mf.calibration.Bootstrap(options["bootstrap"], options["seed"])
    )


def fitted_shear(
    measured: CalibrationData,
    options: Mapping[str, Any],
    errors: MeasurementErrors,
    names: Names,
    sources: list[str],
) -> ShearCalibration | None:
    """Return B and sigma, None without shear tests."""
    points = measured.shear
    if points is None:
        return None
    try:
        with named(replace(names, places=points.place)):
            return mf.calibration.shear(
                points.area_before,
                points.area_sheared,
                points.friction_force,
                errors=errors,
                test=points.test,
                bootstrap=_bootstrap(options),
            )
    except InvalidInput as error:
        raise mf.files.of_files(error, sources) from None


def fitted_strength(
    options: Mapping[str, Any],
    errors: MeasurementErrors,
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
) -> StrengthFit | None:
    """Return sigma of a part in full contact, with E* and B from the other tables or from its folder."""
    given = {
        name: options[name] for name in ("full_contact", "part", "load_min") if options[name] is not None
    }
    if not given:
        return None
    missing = [option_name(name) for name in ("full_contact", "part", "load_min") if name not in given]
    if missing:
        raise InvalidInput(
            f"{' and '.join(missing)} must be given too, as in --full-contact measured.csv --part linear "
            '--load-min "0.5 N"'
        )
    design = loaded(given["part"])
    surface = design.surface
    if contact is not None:
        surface = surface.replaced(material=contact.material)
    if shear is not None:
        surface = surface.replaced(friction=shear.friction)
    if surface.friction is None:
        raise InvalidInput(
            f"the area ratio B is not known: the part of {given['part']} has no friction; add a shear test"
        )
    law = mf.files.read_measured_law(given["full_contact"], surface.material, surface.friction, errors=errors)
    calibrations = [each for each in (contact, shear) if each is not None]
    known: dict[str, Any] = {}
    if calibrations:
        names, covariance = mf.calibration.joint_covariance(*calibrations)
        known = {"covariance": covariance, "parameters": names}
    with named(written_names(options)):
        least = mf.files.quantity("--load-min", given["load_min"], "N", "0.5 N")
        return mf.calibration.shear_strength(law, surface, least, model=design.law.model, **known)
