"""Bounds that are known before a design: friction coefficients and plasticity."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

from metafem import _validate as check
from metafem._calls import checked_call
from metafem.errors import InvalidInput, MetafemWarning
from metafem.inversion.height_density import TruncatedExponential, uniform_slope
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii, RadiusRange
from metafem.inversion.strategies.exponential import FINEST_SCALE_IN_SD
from metafem.surface import Surface

# Limit of mostly elastic contact by Greenwood and Williamson.
ELASTIC_LIMIT = 0.6


@checked_call
def achievable_friction_coefficients(
    template: Surface, limits: Limits, radii: RadiusRange | Sequence[float] | None = None
) -> tuple[float, float]:
    """Bounds on the friction coefficient of a linear law.

    The lower bound is that of uniformly distributed heights, ``3 pi/4 sqrt(R/h_m) sigma B / E*``. The
    upper bound is that of the smallest scale that can be made, ten times `limits.height_sd`; without a
    `height_sd` it is infinite. Where each asperity may have one of several radii, the lower bound is that
    of the least radius and the upper bound that of the largest; mixtures reach all values between.

    Parameters
    ----------
    template : Surface
        With a friction, and one common radius unless `radii` is given.
    limits : Limits
    radii : RadiusRange or sequence of float, optional
        Radii that each asperity may have [mm]; default: the radius of the template.

    Returns
    -------
    low, high : float
        Friction coefficients mu [-].

    Raises
    ------
    InvalidInput
        For a template without a friction or with several radii, and radii that are not positive.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(
    ...     0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    ... )
    >>> limits = Limits(max_height=0.120, height_sd=0.0009)
    >>> [round(mu, 3) for mu in achievable_friction_coefficients(template, limits)]
    [1.104, 3.032]
    """
    check.instance("limits", limits, Limits, "metafem.Limits")
    if template.friction is None:
        raise InvalidInput("template has no friction; a friction coefficient needs metafem.Friction")
    choice = Radii.common(template) if radii is None else Radii.given(radii)
    per_slope = (
        template.friction.shear_strength * template.friction.area_ratio / template.material.composite_modulus
    )
    low = uniform_slope(choice.low, limits.span)
    high = math.inf
    if limits.height_sd:
        finest = TruncatedExponential(FINEST_SCALE_IN_SD * limits.height_sd, limits.span)
        high = finest.asymptotic_slope(choice.high)
    return low * per_slope, high * per_slope


@checked_call
def plasticity_index(surface: Surface, hardness: float) -> float:
    """Plasticity index of a surface, ``psi = E*/H sqrt(s/R)``.

    Here s is the standard deviation of the heights and R the mean radius. An elastic model is suitable
    below 0.6; above, a MetafemWarning is issued.

    Parameters
    ----------
    surface : Surface
    hardness : float
        H [MPa], positive.

    Returns
    -------
    float
        psi [-].

    Notes
    -----
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.1, 0.2], (1, 2), radius=0.5, material=mf.Material(1.36))
    >>> round(plasticity_index(surface, hardness=10.0), 4)
    0.043
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    h = check.number("hardness", hardness, above=0.0)
    ratio = surface.material.composite_modulus / h
    psi = ratio * math.sqrt(float(surface.height.std()) / float(surface.radius.mean()))
    if psi >= ELASTIC_LIMIT:
        warnings.warn(
            f"plasticity index {psi:.3g} is not below {ELASTIC_LIMIT}: the contacts will deform "
            "plastically; choose a material with a smaller E*/H, larger radii or closer heights",
            MetafemWarning,
            stacklevel=2,
        )
    return psi
