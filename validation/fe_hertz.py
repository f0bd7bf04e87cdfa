"""Hertz's contact by high-order finite elements, and by a search on an ordinary mesh."""

from __future__ import annotations

import numpy as np

from metafem import fe
from metafem.fe.checks import search_convergence, spectral_convergence
from metafem.reference import single_contacts as exact
from metafem.report.svg import new_figure
from validation.check import Claim, from_elements

A, R = 0.2, 0.526


def claim() -> Claim:
    """Compare load, indentation and field, and fit the rates."""
    return Claim(
        "Finite elements: Hertz's contact on a half-space",
        from_elements(fe.hertz_check()),
        {"fields": _fields, "rates": _rates},
    )


def _fields():
    contact = fe.press(A, R)
    inside, outside = np.linspace(0.0, A, 60), A * np.linspace(1.0, 5.0, 80)[1:]
    figure = new_figure(8.0, 3.2)
    left, right = figure.subplots(1, 2)
    left.plot(inside / A, contact.pressure(inside), ".", ms=4, label="finite elements")
    left.plot(inside / A, exact.hertz_pressure(inside, A, R), "k-", lw=0.8, label="Hertz")
    left.set(xlabel="r/a", ylabel="pressure p/E*")
    left.legend(frameon=False)
    right.plot(outside / A, contact.displacement(outside) * 1e3, ".", ms=4)
    right.plot(outside / A, exact.hertz_displacement(outside, A, R) * 1e3, "k-", lw=0.8)
    right.set(xlabel="r/a", ylabel="displacement outside [µm]")
    return figure


def _rates():
    figure = new_figure(8.0, 3.2)
    left, right = figure.subplots(1, 2)
    spectrum = spectral_convergence()
    left.semilogy(spectrum.value, spectrum.error, "o-", label=f"{-spectrum.rate:.2f} digits a degree")
    left.set(xlabel="degree of the elements", ylabel="relative error of the load")
    left.legend(frameon=False)
    for name, study in zip(("load", "radius"), search_convergence(), strict=True):
        right.loglog(study.value, study.error, "o-", label=f"{name}: order {study.rate:.1f}")
    right.set(xlabel="cell / contact radius", ylabel="relative error, active set")
    right.legend(frameon=False)
    return figure
