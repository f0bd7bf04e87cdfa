"""Hertz's contact by high-order elements and by an active set on an ordinary mesh."""

from __future__ import annotations

from metafem import fe, studies
from metafem.drawing import new_figure
from metafem.report.elements import hertz_figure
from metafem.studies.element_checks import search_convergence, spectral_convergence
from validation.check import Claim, of_elements

A, R = 0.2, 0.526

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """Compare load, indentation and field, and fit the rates."""
    return Claim(
        "Finite elements: Hertz's contact on a half-space",
        of_elements(studies.hertz_check()),
        {"fields": _fields, "rates": _rates},
    )


def _fields():
    return hertz_figure(fe.press(A, R), R)


def _rates():
    figure = new_figure(8.0, 3.2)
    left, right = figure.subplots(1, 2)
    spectrum = spectral_convergence()
    left.semilogy(spectrum.value, spectrum.error, "o-", label=f"{-spectrum.rate:.2f} digits per degree")
    left.set(xlabel="degree of the elements", ylabel="relative error of the load")
    left.legend(frameon=False)
    for name, study in zip(("load", "radius"), search_convergence(), strict=True):
        right.loglog(study.value, study.error, "o-", label=f"{name}: order {study.rate:.1f}")
    right.set(xlabel="cell / contact radius", ylabel="relative error, active set")
    right.legend(frameon=False)
    return figure
