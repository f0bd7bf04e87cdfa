"""Measurement of a made surface on a map of its heights."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray, IntArray
from metafem._values import MICROMETRES, Value, span
from metafem.calibration.topography.alignment import aligned, on_map, placement_notes
from metafem.calibration.topography.caps import Cap, fitted_caps, pooled
from metafem.calibration.topography.cells import HeightMap, cells
from metafem.calibration.topography.levelled import Levelling, levelled
from metafem.calibration.topography.summits import hills
from metafem.caps import SPHERE
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note
from metafem.progress import doing
from metafem.surface import Surface

# Number of cells across the smallest cap of the design in the search for summits.
ACROSS = 10

# Summits are sought above this fraction of the smallest height of the design.
LOWEST = 0.25

# Smallest height of a cap over its radius [-]; 5 um for the paper's radius. Lower caps cannot be
# distinguished from roughness.
FLATTEST = 0.01

# Smallest number of pixels of a map along each axis.
FEWEST = 16


@dataclass(frozen=True, eq=False, repr=False)
class MadeSurface(Value):
    """Measured surface of a part, and its design.

    Attributes
    ----------
    surface : Surface
        Asperities that were found, with heights above the base plane, radii, and positions in the design's
        coordinates. The design provides material, friction and block.
    design : Surface
        Designed surface.
    site : ndarray of int, (n,)
        Number of the design's asperity for each measured asperity.
    height_sd, radius_sd, position_sd : ndarray, (n,)
        Standard deviations of height, radius and each position coordinate [mm].
    levelling : Levelling
        Tilt and bow that were subtracted.
    missing : ndarray of int
        Numbers of the design's asperities that were not found.
    roughness : float
        Standard deviation of the pixels' distances from the spheres [mm].
    rotation : float
        Angle of the part on the map, anticlockwise, including quarter turns [rad].
    mirrored : bool
        Whether the map is a mirror image of the part.
    on_map : ndarray, (n, 2)
        Positions of the summits on the map, relative to its lower left corner [mm].
    notes : tuple of Note
    height_error, radius_error : ndarray, (n,)
        Made minus designed [mm].
    position_error : ndarray, (n, 2)
        Made minus designed [mm].

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.425**2)) - 0.425
    >>> made = mf.calibration.measured_surface(cap, 0.004, design)
    >>> made.height_error.round(6), made.missing
    (array([0.001]), array([], dtype=int64))
    """

    surface: Surface
    design: Surface
    site: IntArray
    height_sd: FloatArray
    radius_sd: FloatArray
    position_sd: FloatArray
    levelling: Levelling
    missing: IntArray
    roughness: float
    rotation: float
    mirrored: bool
    on_map: FloatArray
    notes: tuple[Note, ...] = ()

    @property
    def height_error(self) -> FloatArray:
        """Made minus designed heights, (n,) [mm]."""
        return self.surface.height - self.design.height[self.site]

    @property
    def radius_error(self) -> FloatArray:
        """Made minus designed radii, (n,) [mm]."""
        return self.surface.radius - self.design.radius[self.site]

    @property
    def position_error(self) -> FloatArray:
        """Made minus designed positions, (n, 2) [mm]."""
        return self.surface.position - self.design.position[self.site]

    def __repr__(self) -> str:
        error = MICROMETRES * self.height_error
        return (
            f"<MadeSurface: {self.surface.count} of {self.design.count} asperities, height error "
            f"{error.mean():.3g} um on average with s.d. {error.std():.3g} um, radius "
            f"{span(self.surface.radius, 'mm')}>"
        )


def measured_surface(
    height_map: ArrayLike,
    pixel_size: float | tuple[float, float],
    design_surface: Surface,
    *,
    bow: bool = True,
    steepest: float = 1.0,
    common_radius: bool = False,
    mould: bool = False,
    mirrored: bool | None = None,
) -> MadeSurface:
    """Return the made surface: heights, radii and positions of the asperities on a map of heights.

    The base plane (tilt and bow) is fitted between the caps. A sphere ``z = h - R + sqrt(R^2 - rho^2)`` is
    fitted to the part of each cap that belongs to the upper nine tenths of its height and has a slope below
    `steepest`. This large part is used because it contains the most information. For roughness with the
    standard deviation s and the covariance ``s^2 exp(-r^2/l^2)`` on a circle of radius a, the standard errors
    are ``2 s l/a`` for the height, ``4 sqrt(3) s l R^2/a^3`` for the radius and ``2 s l R/a^2`` for each
    coordinate, to first order in a/R and l/a. No unbiased estimate is better by more than terms of order l/a.
    For caps 0.05 to 0.27 mm high with R = 0.526 mm and an arithmetic roughness of 1.2 um, the root mean
    square error of the heights is at most 0.1 um up to l = 12 um, or up to l = 23 um with a common radius.
    The returned standard errors are computed from the correlation of the measured residuals.

    Parameters
    ----------
    height_map : array_like, (rows, columns)
        Heights [mm], nan where not measured. As in an image, columns run along x and rows downwards along -y.
    pixel_size : float or (float, float)
        Distance between the centres of neighbouring pixels [mm], or the two distances along x and y.
    design_surface : Surface
        Designed surface, with the sites and the size of the caps.
    bow : bool
        Whether to subtract a second-order surface instead of a plane; default: True. This also subtracts a
        bow of the part itself. A block glued to glass has no bow, but a free block may have one.
    steepest : float
        Largest slope at which a cap is used [-], positive; default: 1 (45 degrees).
    common_radius : bool
        Whether all caps have the same radius, for example because one tool made them; default: False. A
        common radius halves the errors of the heights.
    mould : bool
        Whether the map shows the mould, whose holes form the caps; default: False.
    mirrored : bool, optional
        Whether the map is a mirror image of the part; default: the value of `mould`.

    Returns
    -------
    MadeSurface

    Raises
    ------
    InvalidInput
        If the map is too small or shows no base plane, if it shows no cap with a radius within a factor of
        two of the design's radius, if no cap lies on a site, or if the caps of the design are not spheres.

    Notes
    -----
    ISO 25178-2 defines the autocorrelation length of a surface as the distance of the fastest decay of the
    autocorrelation to 0.2. For the covariance above it is 1.27 l. For the least-squares fit of spheres see
    Forbes, NPL Report DITC 140/89 (1991).

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.426**2)) - 0.426
    >>> made = mf.calibration.measured_surface(cap + 0.002 * x, 0.004, design)
    >>> made.surface.height.round(6), made.surface.radius.round(6)
    (array([0.1]), array([0.526]))
    """
    check.instance("design_surface", design_surface, Surface, "a metafem.Surface")
    limit = check.number("steepest", steepest, above=0.0)
    picture = _height_map(height_map, pixel_size, mould)
    design = design_surface
    refuse_if(
        design.cap != SPHERE,
        f"must be {SPHERE!r}: spheres are fitted to the map. Measure summits of other caps by other means, "
        "and set their heights by surface.replaced(height=...)",
        key="design_surface.cap",
        value=repr(design.cap),
    )
    with doing("measuring the surface"):
        level, every, covariance, other = _spheres(picture, design, bow, limit, mould)
    caps = [cap for cap in every if not cap.cause]
    notes = [
        Note(f"the cap at {on_map(cap.x, cap.y)} on the map was not measured: {cap.cause}")
        for cap in every
        if cap.cause
    ]
    if not caps:
        raise InvalidInput(f"the map shows no cap that can be measured; {notes[0].text}")
    covariance = covariance[[not cap.cause for cap in every]]
    value = np.array([[cap.x, cap.y, cap.height, cap.radius] for cap in caps])
    if common_radius:
        value, covariance = pooled(value, covariance)
    place = aligned(value[:, :2], value[:, 2], design, mould if mirrored is None else mirrored)
    matched = np.flatnonzero(place.site >= 0)
    refuse_if(not matched.size, f"none of the {len(caps)} caps of the map lies on a site of the design")
    order = matched[np.argsort(place.site[matched])]
    site = place.site[order].astype(np.int64)
    missing = np.setdiff1d(np.arange(design.count), site)
    notes += placement_notes(design, value[:, :2], place, missing, other)
    x, y, height, radii = value[order].T
    variance = np.diagonal(covariance[order], axis1=1, axis2=2)
    return MadeSurface(
        surface=design.only(site, position=place.position[order], height=height, radius=radii),
        design=design,
        site=site,
        height_sd=np.sqrt(variance[:, 2] + level.base_sd(x, y) ** 2),
        radius_sd=np.sqrt(variance[:, 3]),
        position_sd=np.sqrt(variance[:, :2].mean(axis=1)),
        levelling=level,
        missing=missing.astype(np.int64),
        roughness=float(np.sqrt(np.mean([cap.sd**2 for cap in caps]))),
        rotation=place.rotation,
        mirrored=place.mirrored,
        on_map=value[order, :2],
        notes=tuple(notes),
    )


def _spheres(
    picture: HeightMap, design: Surface, bow: bool, steepest: float, mould: bool
) -> tuple[Levelling, list[Cap], FloatArray, list[tuple[float, float]]]:
    """Return the base plane, the fitted caps, their covariance, and the centres of other hills [mm]."""
    lowest = _lowest(design)
    foot = math.sqrt(lowest * (2.0 * float(design.radius.min()) - lowest))
    side = max(1, int(2.0 * foot / ACROSS / max(picture.pixel)))
    if min(picture.values.shape) < FEWEST * side:
        side = max(1, min(picture.values.shape) // FEWEST)
    found = cells(picture, side)
    radius = float(np.median(design.radius))
    on_hills, starts, other = hills(found, levelled(picture, found, bow), LOWEST * lowest, radius)
    level = levelled(picture, found, bow, on_hills)
    hill = "1 hill of another shape" if len(other) == 1 else f"{len(other)} hills of other shapes"
    names = ("pixel_size", "the unit of the heights", f"mould={not mould}")
    must = f"the map shows no cap of a radius near {radius:g} mm, but {hill}; check "
    refuse_if(not starts, must + "{.name}, {.name} and {.name}", *map(Given, names))
    return level, *fitted_caps(picture, level, starts, steepest), other


def _height_map(values: ArrayLike, pixel_size: float | tuple[float, float], mould: bool) -> HeightMap:
    """Return the checked height map, without a copy of the heights."""
    if check.scalar(pixel_size):
        width = height = check.number("pixel_size", pixel_size, above=0.0)
    else:
        width, height = check.array("pixel_size", pixel_size, shape=(2,), positive=True).tolist()
    try:
        array: NDArray[np.floating] = (
            np.ma.filled(values, np.nan) if np.ma.isMaskedArray(values) else np.asarray(values)
        )
        if array.dtype not in (np.float32, np.float64):
            array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise InvalidInput("height_map is not an array of numbers") from None
    wrong = array.ndim != 2 or min(array.shape) < FEWEST
    must = f"it must have shape (rows, columns), each at least {FEWEST}"
    refuse_if(wrong, f"the map has shape {array.shape}; {must}")
    return HeightMap(array, (width, height), -1.0 if mould else 1.0)


def _lowest(design: Surface) -> float:
    """Return the smallest height of a measurable cap [mm]."""
    measurable = design.height > FLATTEST * design.radius
    refuse_if(not measurable.any(), f"design_surface has no summit above {FLATTEST:g} of its radius")
    return float(min(design.height[measurable].min(), design.radius.min()))
