"""Hertz's contact by high-order elements and by an active set on an ordinary mesh."""

from __future__ import annotations

from metafem import fe, reference
from validation.check import Check, Claim, Picture, near
from validation.figures import panels
from validation.finite_elements.active_set import search_contact
from validation.finite_elements.checks import HERTZ, hertz_check, search_convergence, spectral_convergence
from validation.finite_elements.pictures import hertz_figure

A, R = 0.2, 0.526

# Poisson's ratio of a compressible half-space, and cell of the active set over the contact radius, with which
# its loads are good to 3e-4.
OTHER, CELL = 0.3, 1.0 / 20.3


# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """A paraboloid of R = 526 µm is pressed on a half-space by two finite element methods: high-order
    elements with the contact radius prescribed, in coordinates that remove the singularity at the edge, and
    an active set on ordinary quadratic elements. Load, indentation and displacement are compared with Hertz's
    closed forms, that of a quartic punch with Sneddon's, and the orders of convergence with theory.
    """
    return Claim(
        "Finite elements: Hertz's contact on a half-space",
        [*hertz_check(), _compressible()],
        {"Pressure and displacement": Picture(_fields), "Convergence": Picture(_rates)},
    )


def _compressible() -> Check:
    """Check the active set on a compressible half-space: Hertz's load over E* does not depend on ν."""
    found = search_contact(A**2 / R, R, OTHER, cell=CELL * A)
    exact = reference.hertz(A, R)[0]
    name = f"active set, ν = {OTHER:g}: load over Hertz"
    return near(name, found.rescaled_load / exact, 1.0, 3e-4, HERTZ)


def _fields():
    """Contact pressure over E*, and displacement of the surface, by finite elements and by Hertz's closed
    forms, over the radius. The curves coincide within the width of the lines.
    """
    return hertz_figure(fe.press(A, R), R)


@panels(8.0, 3.2, columns=2)
def _rates(left, right):
    """Relative error of the load against Hertz's. Left: with the degree of the high-order elements the error
    falls exponentially. Right: with the cell of the active set, relative to the contact radius, load and
    radius converge at the orders in the legend, at least 1.
    """
    spectrum = spectral_convergence()
    left.semilogy(spectrum.value, spectrum.error, "o-", label=f"{-spectrum.rate:.2f} digits per degree")
    left.set(xlabel="degree of the elements", ylabel="relative error of the load")
    for name, study in zip(("load", "radius"), search_convergence(), strict=True):
        right.loglog(study.value, study.error, "o-", label=f"{name}: order {study.rate:.1f}")
    right.set(xlabel="cell / contact radius", ylabel="relative error, active set")
