"""The surface that was made, from a map of its heights."""

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
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note
from metafem.progress import doing
from metafem.surface import Surface

# Number of cells across the smallest cap of the design, for the search for summits.
ACROSS = 10

# Summits are searched above this fraction of the lowest height of the design.
LOWEST = 0.25

# Caps lower than this fraction of their radius look like roughness [-]: 5 um for the paper's radius.
FLATTEST = 0.01

# A map needs at least this many pixels along each axis.
FEWEST = 16


@dataclass(frozen=True, eq=False, repr=False)
class MadeSurface(Value):
    """A measured surface, with its design.

    Attributes
    ----------
    surface : Surface
        The asperities that were found: heights above the base plane, radii, positions in the design's
        coordinates; material, friction and block are those of the design.
    design : Surface
        The designed surface.
    site : ndarray of int, (n,)
        Asperity of the design for each measured one.
    height_sd, radius_sd, position_sd : ndarray, (n,)
        Standard deviations [mm]; that of the position is along each axis.
    levelling : Levelling
        The tilt and bow that were subtracted.
    missing : ndarray of int
        Asperities of the design that were not found.
    roughness : float
        Standard deviation of the heights about the spheres [mm].
    rotation : float
        Angle of the part on the map, anticlockwise [rad], quarter turns included.
    mirrored : bool
        Whether the map is a mirror image of the part.
    on_map : ndarray, (n, 2)
        Summits on the map, from its lower left corner [mm].
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
    """Measure the heights, radii and positions of the asperities on a map of heights.

    The base plane (tilt and bow) is fitted between the caps, and a sphere ``z = h - R + sqrt(R^2 - rho^2)``
    to the upper nine tenths of each cap where its slope is below `steepest`. The largest possible part of the
    cap is used because it has the most information: for roughness of the standard deviation s with the
    covariance ``s^2 exp(-r^2/l^2)``, white noise on a circle of radius a gives the standard errors
    ``2 s l/a`` of the height, ``4 sqrt(3) s l R^2/a^3`` of the radius and ``2 s l R/a^2`` of each coordinate,
    to first order in a/R and l/a. No unbiased estimate is better by more than terms of the order l/a. Caps of
    0.05 to 0.27 mm with R = 0.526 mm and an arithmetic roughness of 1.2 um have height errors of 0.1 um (root
    mean square) up to l = 12 um, with a common radius up to l = 23 um. The standard errors returned follow
    from the correlation of the measured residuals.

    Parameters
    ----------
    height_map : array_like, (rows, columns)
        Heights [mm], nan where not measured. Columns run along x, rows downwards along -y, as in an image.
    pixel_size : float or (float, float)
        Distance of the centres of two pixels [mm], or those along x and y.
    design_surface : Surface
        The designed surface, for the sites and the size of caps.
    bow : bool
        Whether to subtract a second-order surface, not only a plane; default: True. The bow of the part
        itself is then subtracted as well: a block glued to glass is flat, a free block may not be.
    steepest : float
        Largest slope of a cap that is used [-], positive; default: 1, 45 degrees.
    common_radius : bool
        Whether all caps have one radius, for example if one tool made them; default: False. The errors of the
        heights are then halved.
    mould : bool
        Whether the map shows the mould, whose holes are the caps; default: False.
    mirrored : bool, optional
        Whether the map is a mirror image of the part, as the map of a mould is; default: whichever fits the
        heights better.

    Returns
    -------
    MadeSurface

    Raises
    ------
    InvalidInput
        If the map is too small or holds no base plane, if it shows no cap of a radius within a factor of two
        of the design's, or if no cap has a site.

    Notes
    -----
    ISO 25178-2 defines the autocorrelation length of a surface as the fastest decay to 0.2: 1.27 l here. The
    fit of spheres by least squares of the distances: Forbes, NPL Report DITC 140/89 (1991).

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
    place = aligned(value[:, :2], value[:, 2], design, True if mould and mirrored is None else mirrored)
    matched = np.flatnonzero(place.site >= 0)
    refuse_if(not matched.size, f"none of the {len(caps)} caps of the map lies on a site of the design")
    order = matched[np.argsort(place.site[matched])]
    site = place.site[order].astype(np.int64)
    missing = np.setdiff1d(np.arange(design.count), site)
    notes += placement_notes(design, value[:, :2], place, missing, other)
    x, y, height, radii = value[order].T
    variance = np.diagonal(covariance[order], axis1=1, axis2=2)
    return MadeSurface(
        surface=Surface(place.position[order], height, radii, design.material, design.friction, design.block),
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
    """Return the base plane, the caps with their covariance, and the centres of other hills."""
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
    """Return the checked map; its heights are not copied."""
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
    """Return the smallest height of a cap that can be measured [mm]."""
    measurable = design.height > FLATTEST * design.radius
    refuse_if(not measurable.any(), f"design_surface has no summit above {FLATTEST:g} of its radius")
    return float(min(design.height[measurable].min(), design.radius.min()))
