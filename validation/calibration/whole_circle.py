"""The whole circle: images and forces, material, design, made part, its measured law and what explains it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np

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
    design: mf.Design
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
    circle = _circle()
    causes = {cause.name: cause for cause in circle.explanation.causes}
    made = laboratory.MADE
    checks: list[Row] = [
        below(
            "areas of the contacts of the sample, largest relative error", _area_error(circle), 0.02, AREAS
        ),
        _value("E* [MPa]", circle.contacts.composite_modulus, circle.contacts.covariance[0, 0], 1.36),
        _value(
            "sqrt(w) [sqrt(N/mm)]",
            circle.contacts.adhesion_root,
            circle.contacts.root_covariance[1, 1],
            laboratory.ADHESION_ENERGY**0.5,
        ),
        _value(
            "B", circle.sheared.area_ratio, circle.sheared.covariance[0, 0], laboratory.FRICTION.area_ratio
        ),
        _value(
            "sigma [MPa]",
            circle.sheared.shear_strength,
            circle.sheared.covariance[1, 1],
            laboratory.FRICTION.shear_strength,
        ),
        near("contacts of the part at their sites", float(circle.found.matched), 1.0, 0.0, SITES),
        below("areas of the part, largest relative error of the sum", _sum_error(circle), 0.02, AREAS),
        _value(
            "height scale", causes["height_scale"].mean, causes["height_scale"].sd ** 2, made["scale"] - 1.0
        ),
        _value("tilt along x [rad]", causes["angle_x"].mean, causes["angle_x"].sd ** 2, made["angle"]),
        _value("tilt along y [rad]", causes["angle_y"].mean, causes["angle_y"].sd ** 2, 0.0),
        _value(
            "error of the fitted E*",
            causes["composite_modulus"].mean,
            causes["composite_modulus"].sd ** 2,
            laboratory.MATERIAL.composite_modulus / circle.contacts.composite_modulus - 1.0,
        ),
        _value(
            "error of the fitted sqrt(w)",
            causes["adhesion_root"].mean,
            causes["adhesion_root"].sd ** 2,
            laboratory.ADHESION_ENERGY**0.5 / circle.contacts.adhesion_root - 1.0,
        ),
        below("laws that the errors do not explain", float(not circle.explanation.verdict.fits), 0.0, CHI),
    ]
    return Claim(
        "The whole circle from images to an explained law",
        checks,
        {"from images to an explained law": Picture(partial(_figure, circle))},
    )


def _value(name: str, found: float, variance: float, true: float) -> Check:
    return near(name, found, true, WITHIN * float(variance) ** 0.5, TRUE)


def _area_error(circle: Circle) -> float:
    """Return the largest relative error of an area of the sample, contact by contact."""
    errors = []
    for table, series in zip(circle.tables, circle.samples, strict=True):
        errors.append(np.abs(np.sort(table.area, axis=1) / np.sort(series.area, axis=1) - 1.0).max())
    return float(max(errors))


def _sum_error(circle: Circle) -> float:
    return float(np.abs(circle.found.area.sum(axis=1) / circle.part.area.sum(axis=1) - 1.0).max())


@cache
def _circle() -> Circle:
    samples = laboratory.calibration_tests(TESTS, LOADS, pixel=PIXEL)
    tables = [table_of(series) for series in samples]

    def joined(name: str) -> FloatArray:
        return np.concatenate([getattr(table, name) for table in tables])

    test = [str(number) for number, table in enumerate(tables, 1) for _ in table.load]
    contacts = fit_compression(
        joined("load"),
        joined("area"),
        laboratory.RADIUS,
        sample=Sample(contacts=5),
        test=test,
        area_sd=joined("area_error"),
    )
    sheared = shear(joined("area"), joined("sheared_area"), joined("friction_force"), test=test)
    template = mf.Surface.square_lattice(
        0.12,
        radius=laboratory.RADIUS,
        material=contacts.material,
        friction=sheared.friction,
        block=laboratory.BLOCK,
    )
    model = mf.Independent(contact=contacts.contact_law)
    design = mf.design(mf.LinearLaw(6.87), template, model, limits=mf.Limits(0.12, offset=0.084))
    part = laboratory.part_test(design.surface, pixel=PIXEL)
    found = table_of(part, design.surface)
    measured = MeasuredLaw.from_contacts(found, contacts.material, sheared.friction)
    covariance = np.zeros((3, 3))
    covariance[0, 0], covariance[1:, 1:] = contacts.covariance[0, 0], sheared.covariance
    names = ["composite_modulus", "area_ratio", "shear_strength"]
    comparison = compare(measured, design, parameters=names, covariance=covariance)
    return Circle(
        samples, tables, contacts, sheared, design, part, found, comparison, explain(measured, design)
    )


def table_of(series: laboratory.Series, design: mf.Surface | None = None) -> ContactTable:
    """Return the contacts in the images of a test, at the sites of a design if it is given."""
    before, sheared = (
        stack_areas(list(series.images(state)), series.pixel, series.load) for state in (False, True)
    )
    return track_contacts(
        before,
        [f"image {number}" for number in range(1, len(before) + 1)],
        load=series.load,
        friction_force=series.friction_force,
        sheared=sheared,
        sites=None if design is None else DesignSites(design.position),
    ).table


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
    order = np.argsort(contacts.area.sum(axis=1))
    fit.plot(contacts.area.sum(axis=1)[order], contacts.load_fitted[order], color=ACHIEVED)
    fit.plot(contacts.area.sum(axis=1), contacts.load, "o", ms=3.5, color=MEASURED)
    fit.set_xlabel("area of five contacts [mm²]")
    fit.set_ylabel("load [N]")
    fit.set_title(f"E* = {contacts.composite_modulus:.3f} MPa, true 1.36 MPa", fontsize=10)
    measured, design = circle.comparison.measured, circle.design.law
    law.plot(design.rescaled_load, design.rescaled_friction, color=ACHIEVED, label="design")
    law.errorbar(
        measured.rescaled_load,
        measured.rescaled_friction,
        xerr=measured.rescaled_load_sd,
        yerr=measured.rescaled_friction_sd,
        fmt="o",
        ms=3.5,
        color=MEASURED,
        label="measured",
    )
    law.set_xlim(0.0, 1.05 * measured.rescaled_load.max())
    law.set_ylim(0.0, 1.1 * measured.rescaled_friction.max())
    law.set_xlabel("rescaled load  P/E* [mm²]")
    law.set_ylabel("rescaled friction  F/(σB) [mm²]")
    shares = list(circle.explanation.shares.items())[::-1]
    causes.barh([name.replace("_", " ") for name, _ in shares], [share for _, share in shares], color=QUIET)
    causes.set_xlabel("share of the explained difference")
    causes.axvline(0.0, color=TARGET, lw=0.8)
