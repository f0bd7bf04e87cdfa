"""The whole circle: images and forces, material, design, made part, its measured law and what explains it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.linalg import block_diag

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import (
    Comparison,
    ContactCalibration,
    ContactTable,
    DesignSites,
    Explanation,
    MeasuredLaw,
    Sample,
    ShearCalibration,
    compare,
    explain,
    fit_compression,
    shear,
    stack_areas,
    track_contacts,
)
from metafem.drawing import ACHIEVED, MEASURED, QUIET, TARGET
from validation.check import Check, Claim, Picture, Row, below, near
from validation.figures import panels
from validation.scenes import laboratory
from validation.sources import known_input

SLOW = True

# Tests of the calibration sample, loads of each, and pixel size [mm]: two and a half times that of the paper.
TESTS, LOADS, PIXEL = 2, 8, 0.012

TRUE = known_input("value of the synthetic laboratory, within three standard deviations")
SITES = known_input("sites of the synthetic part")
AREAS = known_input("areas of the synthetic contacts, of radii of 7 pixels and more")
CHI = known_input("the synthetic part has no other errors than those that are looked for")


# Standard deviations within which a value counts as found; 99.7 % of correct ones are.
WITHIN = 3.0


@dataclass(frozen=True)
class Circle:
    """What each step of the circle found."""

    samples: list[laboratory.Series]
    tables: list[ContactTable]
    contacts: ContactCalibration
    sheared: ShearCalibration
    part: laboratory.Series
    found: ContactTable
    comparison: Comparison
    explanation: Explanation


def claim() -> Claim:
    """All steps of the paper are carried out once with synthetic images and forces, of which the truth is
    known: images of a calibration sample give E*, adhesion, B and σ; with these a surface is designed, made
    with errors, photographed and sheared; its measured law is compared with the design and explained. Every
    quantity that is found agrees within three standard deviations with the true one.
    """
    circle, made = _circle(), laboratory.MADE
    contacts, sheared, explanation = circle.contacts, circle.sheared, circle.explanation
    (modulus_square, _), (_, root_square) = contacts.root_covariance
    ratio_square, strength_square = np.diag(sheared.covariance)
    friction, root = laboratory.FRICTION, laboratory.ADHESION_ENERGY**0.5
    stiffer = laboratory.MATERIAL.composite_modulus / contacts.composite_modulus
    calibrated = (
        ("E* [MPa]", contacts.composite_modulus, modulus_square, 1.36),
        ("sqrt(w) [sqrt(N/mm)]", contacts.adhesion_root, root_square, root),
        ("B", sheared.area_ratio, ratio_square, friction.area_ratio),
        ("sigma [MPa]", sheared.shear_strength, strength_square, friction.shear_strength),
    )
    explained = (
        ("height scale", "height_scale", made["scale"] - 1.0),
        ("tilt along x [rad]", "angle_x", made["angle"]),
        ("tilt along y [rad]", "angle_y", 0.0),
        ("error of the fitted E*", "composite_modulus", stiffer - 1.0),
    )
    errors = ((name, explanation.mean[key], explanation.sd[key] ** 2, true) for name, key, true in explained)
    each = [
        np.abs(np.sort(table.area, axis=1) / np.sort(series.area, axis=1) - 1.0).max()
        for table, series in zip(circle.tables, circle.samples, strict=True)
    ]
    total = np.abs(circle.found.area.sum(axis=1) / circle.part.area.sum(axis=1) - 1.0).max()
    checks: list[Row] = [
        below("areas of the contacts of the sample, largest relative error", max(each), 0.02, AREAS),
        *(_value(*row) for row in calibrated),
        near("contacts of the part at their sites", float(circle.found.matched), 1.0, 0.0, SITES),
        below("areas of the part, largest relative error of the sum", total, 0.02, AREAS),
        *(_value(*row) for row in errors),
        below("laws that the errors do not explain", float(not explanation.verdict.fits), 0.0, CHI),
    ]
    picture = Picture(partial(_figure, circle))
    title = "from images to an explained law"
    return Claim("The whole circle from images to an explained law", checks, {title: picture})


def _value(name: str, found: float, variance: float, true: float) -> Check:
    return near(name, found, true, WITHIN * float(variance) ** 0.5, TRUE)


@cache
def _circle() -> Circle:
    samples = laboratory.calibration_tests(TESTS, LOADS, pixel=PIXEL)
    tables = [table_of(series) for series in samples]

    def joined(name: str) -> FloatArray:
        return np.concatenate([getattr(table, name) for table in tables])

    test = [str(number) for number, table in enumerate(tables, 1) for _ in table.load]
    load, area, after, force = map(joined, ("load", "area", "sheared_area", "friction_force"))
    sample, area_sd = Sample(contacts=5), joined("area_error")
    contacts = fit_compression(load, area, laboratory.RADIUS, sample, test=test, area_sd=area_sd)
    sheared = shear(area, after, force, test=test)
    given = {"material": contacts.material, "friction": sheared.friction, "block": laboratory.BLOCK}
    template = mf.Surface.square_lattice(0.12, radius=laboratory.RADIUS, **given)
    model = mf.Independent(contact=contacts.contact_law)
    design = mf.design(mf.LinearLaw(6.87), template, model, limits=mf.Limits(0.12, offset=0.084))
    part = laboratory.part_test(design.surface, pixel=PIXEL)
    found = table_of(part, design.surface)
    measured = MeasuredLaw.from_contacts(found, contacts.material, sheared.friction)
    covariance = block_diag(contacts.covariance[:1, :1], sheared.covariance)
    names = ["composite_modulus", "area_ratio", "shear_strength"]
    comparison = compare(measured, design, parameters=names, covariance=covariance)
    return Circle(samples, tables, contacts, sheared, part, found, comparison, explain(measured, design))


def table_of(series: laboratory.Series, design: mf.Surface | None = None) -> ContactTable:
    """Return the contacts in the images of a test, at the sites of a design if it is given."""
    before, sheared = (
        stack_areas(list(series.images(state)), series.pixel, series.load) for state in (False, True)
    )
    names = [f"image {number}" for number in range(1, len(before) + 1)]
    forces = {"load": series.load, "friction_force": series.friction_force}
    sites = None if design is None else DesignSites(design.position)
    return track_contacts(before, names, **forces, sheared=sheared, sites=sites).table


@panels(10.0, 7.6, rows=2, columns=2)
def _figure(circle: Circle, image, fit, law, causes) -> None:
    """An image of the synthetic part; loads and areas of the calibration sample with the fitted contact law;
    the measured friction law of the part (points) beside that of the design (line), from which it differs
    because of the errors with which the part was made; and the errors that explain the difference.
    """
    image.imshow(circle.part.image(len(circle.part.load) - 1, False), cmap="gray", origin="upper")
    image.set_axis_off()
    image.set_title("the part at its largest load", fontsize=10)
    contacts = circle.contacts
    fit.plot(contacts.law_area, contacts.law_load, color=ACHIEVED)
    fit.plot(contacts.total_area, contacts.load, "o", ms=3.5, color=MEASURED)
    fit.set(xlabel="area of five contacts [mm²]", ylabel="load [N]")
    fit.set_title(f"E* = {contacts.composite_modulus:.3f} MPa, true 1.36 MPa", fontsize=10)
    measured = circle.comparison.measured
    x, y = measured.rescaled_load, measured.rescaled_friction
    sd = measured.rescaled_friction_sd, measured.rescaled_load_sd
    law.plot(x, circle.comparison.predicted, color=ACHIEVED, label="design")
    law.errorbar(x, y, *sd, fmt="o", ms=3.5, color=MEASURED, label="measured")
    law.set(xlim=(0.0, 1.05 * x.max()), ylim=(0.0, 1.1 * y.max()))
    law.set(xlabel="rescaled load  P/E* [mm²]", ylabel="rescaled friction  F/(σB) [mm²]")
    found = circle.explanation
    names = list(found.mean)[::-1]
    ratio, sd = ([of[name] / found.expected[name] for name in names] for of in (found.mean, found.sd))
    causes.barh([name.replace("_", " ") for name in names], ratio, xerr=sd, color=QUIET)
    causes.set_xlabel("error over its expected standard deviation")
    causes.axvline(0.0, color=TARGET, lw=0.8)
