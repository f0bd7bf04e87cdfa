"""Made surface on a map of heights: level it, fit spheres to the caps, match them to the design, errors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent
from metafem.calibration.sites import FEWEST as FEWEST_SITES
from metafem.calibration.sites import Sites, complex_points, real_points
from metafem.caps import SPHERE
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.progress import each as told
from metafem.surface import Surface

# Ratio of the standard deviation of a normal variable to the median of its absolute value.
SD_OF_MEDIAN = 1.4826

# Distance from the base plane or from a sphere beyond which a value is an outlier, in standard deviations.
# For a normal variable, one value in 150,000 is farther away.
OUTLIER = 4.5

# Smallest number of pixels of a map along each axis. A cell is used if MEASURED of its pixels were measured.
FEWEST, MEASURED = 16, 0.1

# Number of cells across the smallest cap of the design in the search for summits. Summits are sought above
# LOWEST of the smallest height of the design, and above ABOVE robust standard deviations of the cells.
ACROSS, LOWEST, ABOVE = 10, 0.25, 6.0

# Smallest height of a cap over its radius [-]; 5 um for the paper's radius. Lower caps cannot be
# distinguished from roughness.
FLATTEST = 0.01

# Smallest number of cells of a cap, twice the number of unknowns; smaller hills are assumed to be dust. The
# initial guess of a sphere is fitted to the cells above UPPER of the height of a hill, without its foot.
# RADIUS_FACTOR is the largest ratio between its radius and that of the design.
CELLS, UPPER, RADIUS_FACTOR = 8, 0.3, 2.0

# Number of reweighting steps of the base plane; 25 suffice if 40 % of the cells are on caps. Smallest number
# of cells, five for each of six unknowns.
STEPS, PLANE_CELLS = 25, 30

# Powers of x and y of a plane with bow; the first three are those of a plane.
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))

# Largest slope at which a cap is used [-], 45 degrees; microscopes do not see steeper flanks. Lowest fraction
# of a cap's height, which the fit leaves out because tool and microscope round the foot.
STEEPEST, FOOT = 1.0, 0.1

# Number of steps of a sphere's fit, of which the first update the pixels that are used; four updates suffice
# if the guess is wrong by a tenth of the radius, and then steps converge quadratically.
ROUNDS, FOLLOWED = 12, 6

# A fit has converged if the last change of the height is at most this fraction of its standard error for
# white noise, the smallest possible one. Smallest number of pixels of a cap, five for each unknown.
NEGLIGIBLE, PIXELS = 0.1, 20

# Margin around an outlier that the fit also leaves out [pixels]; smallest standard deviation of the distances
# over the radius, the resolution of single precision.
BESIDE, RESOLUTION = 3, float(np.finfo(np.float32).eps)

# Number of larger blocks across a cap, whose sums show the correlation of its roughness.
SUMMED = 6

# Largest angle between the axes of the map and the axes of the part, in addition to quarter turns. Another
# orientation fits as well if its height misfit is not DECIDED times that of the best one.
TURN, DECIDED = math.radians(20.0), 1.5

# Largest relative error of distances on the map without a note, typical of microscopes.
SCALE = 2e-3

# A note is added if the standard deviation of the height errors exceeds FOREIGN of the standard deviation and
# FOREIGN_MEAN of the mean of the designed heights. Manufacturing errors are a few percent; if the map shows
# another part, the errors are as large as the differences between heights.
FOREIGN, FOREIGN_MEAN = 0.5, 0.05

# Largest number of caps, hills or missing asperities whose places a note lists.
NAMED = 5


class Map(NamedTuple):
    """Heights [mm], (rows, columns), nan where not measured, and the coordinates of columns and rows [mm].

    The origin is the lower left corner. y points upwards, and the first row is at the top.
    """

    z: NDArray[np.floating]
    x: FloatArray
    y: FloatArray

    def window(self, x: float, y: float, reach: float) -> tuple[slice, slice]:
        """Return the rows and columns within `reach` [mm] of a point along both axes."""
        near = (np.flatnonzero(np.abs(axis - at) <= reach) for axis, at in ((self.y, y), (self.x, x)))
        rows, columns = (slice(i[0], i[-1] + 1) if i.size else slice(0) for i in near)
        return rows, columns

    def cells(self, side: int) -> Map:
        """Return the map of the means over cells of `side` x `side` pixels; incomplete cells are left out."""
        from skimage.measure import block_reduce

        rows, columns = (side * (length // side) for length in self.z.shape)
        z, known = self.z[:rows, :columns], np.isfinite(self.z[:rows, :columns])
        share = block_reduce(known, side, np.mean)  # type: ignore[no-untyped-call]
        total = block_reduce(np.where(known, z, 0.0), side, np.mean)  # type: ignore[no-untyped-call]
        mean = np.where(share >= MEASURED, total / np.maximum(share, MEASURED), np.nan)
        x, y = (
            axis[: len(axis) - len(axis) % side].reshape(-1, side).mean(axis=1) for axis in (self.x, self.y)
        )
        return Map(mean, x, y)


class Base(NamedTuple):
    """Base plane of a map: coefficients of the powers of x and y about the centre of the map, the robust
    standard deviation of the cells about it, and its mean standard error [mm].
    """

    coefficient: FloatArray
    centre: FloatArray
    sd: float
    error: float

    def height(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the height at the points of a grid, (len(y), len(x)) [mm]."""
        u, v = x - self.centre[0], (y - self.centre[1])[:, None]
        return np.asarray(sum(c * u**i * v**j for c, (i, j) in zip(self.coefficient, POWERS, strict=False)))


def base_plane(found: Map, bow: bool, free: Any = True) -> Base:
    """Return the base plane, fitted to the mean heights of the `free` cells.

    The fit starts with least absolute deviations and continues with least squares over the cells within 4.5
    robust standard deviations of the plane. Only the cells below the plane determine this standard deviation,
    because caps and dust lie above it.
    """
    centre = np.array([found.x.mean(), found.y.mean()])
    extent = float(np.ptp(found.x) + np.ptp(found.y))
    u, v = np.meshgrid((found.x - centre[0]) / extent, (found.y - centre[1]) / extent)
    powers = POWERS[: 6 if bow else 3]
    known = np.isfinite(found.z) & free
    few = f"the map has {int(known.sum())} cells with heights between its summits; at least {PLANE_CELLS} are"
    refuse_if(known.sum() < PLANE_CELLS, f"{few} needed for the base plane")
    matrix, values = np.array([u[known] ** i * v[known] ** j for i, j in powers]).T, found.z[known]
    weight = np.ones(len(values))
    for _ in range(STEPS):
        fit = np.linalg.lstsq(matrix * weight[:, None], values * weight, rcond=None)[0]
        size = np.abs(values - matrix @ fit)
        weight = 1.0 / np.sqrt(np.maximum(size, 1e-3 * size.mean() + np.finfo(float).tiny))
    inside = np.ones(len(values), dtype=bool)
    for _ in range(STEPS):
        residual = values - matrix @ fit
        middle = float(np.median(residual[inside]))
        sd = SD_OF_MEDIAN * float(np.median(middle - residual[residual <= middle]))
        before, inside = inside, np.abs(residual - middle) <= OUTLIER * sd
        lie = "its cells between the summits do not lie on one"
        refuse_if(inside.sum() < PLANE_CELLS, f"the map holds no base plane: {lie}")
        fit = np.linalg.lstsq(matrix[inside], values[inside], rcond=None)[0]
        if np.array_equal(before, inside):
            break
    rest = np.zeros(found.z.shape)
    rest[known] = np.where(inside, residual, 0.0)
    variance = float((residual[inside] ** 2).mean()) * correlated([rest], len(powers), 1)
    scale = extent ** -np.array([i + j for i, j in powers], dtype=float)
    return Base(fit * scale, centre, sd, math.sqrt(variance * len(powers) / inside.sum()))


def correlated(residuals: list[FloatArray], parameters: int, side: int) -> float:
    """Return the number of pixels per independent value of correlated residuals, 0 where not measured.

    It is the variance of the sum over a block, over that of independent pixels. A block of side b lacks the
    correlation across its boundary, a share of order 1/b of its root; the limit follows from blocks of b and
    2 b. A fit of p parameters to N pixels reduces the variance of sums over blocks of n pixels by p n/N.
    """
    from skimage.measure import block_reduce

    squares = sum(float((each**2).sum()) for each in residuals)
    if not squares:
        return 1.0
    root = []
    for size in (side, 2 * side):
        total = 0.0
        for each in residuals:
            sums = block_reduce(each, size, np.sum)  # type: ignore[no-untyped-call]
            left = 1.0 - parameters * size**2 / np.count_nonzero(each)
            total += float((sums**2).sum()) / max(left, 0.5)
        root.append(math.sqrt(total / squares))
    return max(2.0 * root[1] - root[0], 1.0) ** 2


class Cap(NamedTuple):
    """Sphere on a levelled map: x and y of its centre, height of its summit, radius [mm]."""

    x: float
    y: float
    height: float
    radius: float

    @property
    def part(self) -> float:
        """Return the radius [mm] of the circle within which the cap is above its foot and not too steep."""
        height = (1.0 - FOOT) * self.height
        wide = max(height * (2.0 * self.radius - height), 0.0)
        return min(math.sqrt(wide), STEEPEST / math.hypot(1.0, STEEPEST) * self.radius)

    @property
    def valid(self) -> bool:
        """Whether the summit is above the base plane, and the equator of the sphere below the summit."""
        return 0.0 < self.height < 2.0 * self.radius


def hills(
    found: Map, base: Base, lowest: float, radius: float
) -> tuple[NDArray[np.bool_], list[Cap], list[tuple[float, float]]]:
    """Return a mask of the cells on hills, initial guesses of caps, and the centres of other hills [mm].

    The mask includes a margin. `lowest` is the smallest height of a cap, `radius` the radius of the design
    [mm].
    """
    x, y = np.meshgrid(found.x, found.y)
    above = found.z - base.height(found.x, found.y)
    high = np.nan_to_num(above) > max(ABOVE * base.sd, lowest)
    # close holes in the flanks
    closed = ndimage.binary_closing(high, iterations=2) | high
    label, _ = ndimage.label(closed, np.ones((3, 3)))
    starts, other = [], []
    for number, window in enumerate(ndimage.find_objects(label), 1):
        own = (label[window] == number) & np.isfinite(above[window])
        guess = _sphere(x[window][own], y[window][own], above[window][own])
        if guess and guess.valid and 1.0 / RADIUS_FACTOR <= guess.radius / radius <= RADIUS_FACTOR:
            starts.append(guess)
        else:
            other.append((float(x[window][own].mean()), float(y[window][own].mean())))
    # margin: one cell for the foot of a hill below the threshold, and one for the closing
    return ndimage.binary_dilation(closed, np.ones((3, 3)), iterations=2), starts, other


def _sphere(x: FloatArray, y: FloatArray, z: FloatArray) -> Cap | None:
    """Return the least-squares sphere ``|p|^2 - 2 c p - (R^2 - |c|^2) = 0``, or None for too few points."""
    upper = z > UPPER * z.max()
    if upper.sum() < CELLS:
        return None
    middle = np.array([x[upper].mean(), y[upper].mean(), 0.0])
    points = np.column_stack([x[upper], y[upper], z[upper]]) - middle
    matrix = np.column_stack([2.0 * points, np.ones(len(points))])
    solved = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    radius = math.sqrt(max(solved[3] + (solved[:3] ** 2).sum(), 0.0))
    cx, cy, cz = (solved[:3] + middle).tolist()
    return Cap(cx, cy, cz + radius, radius)


class Fit(NamedTuple):
    """Fitted sphere, inverse normal matrix, distances of the pixels, 0 where not used, and their sd."""

    cap: Cap
    inverse: FloatArray
    distance: FloatArray
    sd: float


def fitted(levelled: Map, start: Cap) -> Fit | None:
    """Return the sphere fitted to one cap by Gauss-Newton steps, or None if it is not found.

    The fit minimises the squared distances from the sphere, integrated over the area of the sphere. Equal
    areas of a rough surface contain equal information, so the squared vertical residual of a pixel has the
    cosine of the slope as weight. Pixels with residuals above 4.5 robust standard deviations are excluded,
    together with their neighbours.
    """
    cap = start
    window = levelled.window(cap.x, cap.y, 1.2 * cap.part)
    z, x, y = levelled.z[window].astype(np.float64), levelled.x[window[1]], levelled.y[window[0]][:, None]
    known, outlier = np.isfinite(z), np.zeros(z.shape, dtype=bool)
    for number in range(ROUNDS):
        dx, dy = np.broadcast_arrays(x - cap.x, y - cap.y)
        square = dx**2 + dy**2
        if number < FOLLOWED:
            within = known & (square <= cap.part**2)
        used = within & ~outlier & (square < cap.radius**2)
        if used.sum() < PIXELS:
            return None
        # z = h - R + q with q = sqrt(R^2 - rho^2), and its derivatives with respect to x, y, h and R
        root = np.sqrt(np.maximum(cap.radius**2 - square, 0.0))
        distance = (z - (cap.height - cap.radius + root)) * root / cap.radius
        q, cosine = root[used], root[used] / cap.radius
        matrix = np.array([dx[used] / q, dy[used] / q, np.ones(q.size), 1.0 / cosine - 1.0])
        inverse = np.linalg.inv((matrix * cosine) @ matrix.T)
        step = inverse @ (matrix @ distance[used])
        sd = SD_OF_MEDIAN * float(np.median(np.abs(distance[used] - np.median(distance[used]))))
        sd = max(sd, RESOLUTION * cap.radius)
        if number + 1 < FOLLOWED:
            far = within & (np.abs(distance) > OUTLIER * sd) & (number > 0)
            outlier = ndimage.binary_dilation(far, iterations=BESIDE) if far.any() else far
        cap = Cap(*(np.array(cap) + step).tolist())
        if not cap.valid:
            return None
        if number >= FOLLOWED and abs(step[2]) <= NEGLIGIBLE * sd / math.sqrt(q.size):
            return Fit(cap, inverse, np.where(used, distance, 0.0), sd)
    return None


class Alignment(NamedTuple):
    """Sites of summits (m,), -1 for no site, and their positions in the design's coordinates (m, 2) [mm].

    `rotation` is the angle of the part on the map, anticlockwise [rad]. `scale` is the ratio of distances on
    the map to distances in the design. `misfit` is the standard deviation of the height errors [mm]. If
    `decided` is false, another orientation or shift of the part fits the heights nearly as well.
    """

    site: IntArray
    position: FloatArray
    rotation: float
    scale: float
    misfit: float
    decided: bool


def aligned(centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool) -> Alignment:
    """Return the alignment of summits (m, 2) with heights (m,) to the sites of a design.

    Of the quarter turns and shifts with the largest number of matched summits, the one that fits the heights
    is used.
    """
    words = f"the map shows {len(centre)} caps and the design has {design.count} asperities"
    few = f"{words}; at least {FEWEST_SITES} of each are needed to match them"
    refuse_if(min(len(centre), design.count) < FEWEST_SITES, few)
    points, sites = complex_points(centre), Sites(complex_points(design.position, mirrored))
    poses = sites.search(points, [0.5 * math.pi * quarter for quarter in range(4)], TURN)
    misfits = [float((height - design.height[pose.site])[pose.site >= 0].std()) for pose in poses]
    near = [i for i, misfit in enumerate(misfits) if misfit <= DECIDED * min(misfits)]
    site, factor = poses[near[0]].site, poses[near[0]].factor
    on_site = site >= 0
    # a rigid motion: the scale of the map is kept
    away = (points - points[on_site].mean()) * abs(factor) / factor
    moved = real_points(away + sites.sites[site[on_site]].mean()) * [-1.0 if mirrored else 1.0, 1.0]
    return Alignment(site, moved, float(np.angle(factor)), abs(factor), misfits[near[0]], len(near) == 1)


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
        Index of the design's asperity for each measured asperity.
    height_sd, radius_sd, position_sd : ndarray, (n,)
        Standard deviations of height, radius and each position coordinate [mm].
    tilt : ndarray, (2,)
        Slopes along x and y that were subtracted [rad].
    bow : ndarray, (3,)
        Coefficients of x^2, x y and y^2 that were subtracted [1/mm].
    missing : ndarray of int
        Indices of the design's asperities that were not found.
    roughness : float
        Standard deviation of the pixels' distances from the spheres [mm].
    rotation : float
        Angle of the part on the map, anticlockwise, including quarter turns [rad].
    notes : tuple of Note
    height_error, radius_error : ndarray, (n,)
        Made minus designed [mm].
    position_error : ndarray, (n, 2)
        Made minus designed [mm].

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface.square_lattice(0.1, (1, 3), 1.2, radius=0.526, material=mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.425**2)) - 0.425
    >>> made = mf.calibration.made_surface(np.tile(cap, 3), 0.004, design)
    >>> made.height_error.round(6), made.missing
    (array([0.001, 0.001, 0.001]), array([], dtype=int64))
    """

    surface: Surface
    design: Surface
    site: IntArray
    height_sd: FloatArray
    radius_sd: FloatArray
    position_sd: FloatArray
    tilt: FloatArray
    bow: FloatArray
    missing: IntArray
    roughness: float
    rotation: float
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


def made_surface(
    height_map: ArrayLike,
    pixel_size: float | tuple[float, float],
    design_surface: Surface,
    *,
    bow: bool = True,
    mould: bool = False,
) -> MadeSurface:
    """Return the made surface: heights, radii and positions of the asperities on a map of heights.

    The base plane (tilt and bow) is fitted between the caps. A sphere ``z = h - R + sqrt(R^2 - rho^2)`` is
    fitted to the part of each cap that belongs to the upper nine tenths of its height and has a slope below
    1. This large part is used because it contains the most information. For roughness with the
    standard deviation s and the covariance ``s^2 exp(-r^2/l^2)`` on a circle of radius a, the standard errors
    are ``2 s l/a`` for the height, ``4 sqrt(3) s l R^2/a^3`` for the radius and ``2 s l R/a^2`` for each
    coordinate, to first order in a/R and l/a. No unbiased estimate is better by more than terms of order l/a.
    For caps 0.05 to 0.27 mm high with R = 0.526 mm and an arithmetic roughness of 1.2 um, the root mean
    square error of the heights is at most 0.1 um up to l = 12 um.
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
    mould : bool
        Whether the map shows the mould, whose holes form the caps, so that it is a mirror image of the part;
        default: False.

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
    >>> design = mf.Surface.square_lattice(0.1, (1, 3), 1.2, radius=0.526, material=mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.426**2)) - 0.426
    >>> made = mf.calibration.made_surface(np.tile(cap, 3) + 5e-6 * np.arange(900), 0.004, design)
    >>> made.surface.height.round(6), made.surface.radius.round(6)
    (array([0.1, 0.1, 0.1]), array([0.526, 0.526, 0.526]))
    """
    check.instance("design_surface", design_surface, Surface, "a metafem.Surface")
    design = design_surface
    refuse_if(
        design.cap != SPHERE,
        f"must be {SPHERE!r}: spheres are fitted to the map. Measure summits of other caps by other means, "
        "and set their heights by surface.replaced(height=...)",
        key="design_surface.cap",
        value=repr(design.cap),
    )
    surface = _map(height_map, pixel_size, mould)
    with doing("measuring the surface"):
        base, starts, other = _levelled(surface, design, bow, mould)
        levelled = surface._replace(z=surface.z - base.height(surface.x, surface.y).astype(surface.z.dtype))
        every = [fitted(levelled, start) for start in told("fitting spheres: summit", starts)]
    fits = [fit for fit in every if fit]
    lost = [(cap.x, cap.y) for cap, fit in zip(starts, every, strict=True) if not fit]
    refuse_if(not fits, "the map shows no cap that can be measured: its hills are no spheres")
    value = np.array([fit.cap for fit in fits])
    pixel = float(np.abs(np.diff(surface.x[:2]))[0])
    side = max(1, round(min(fit.cap.part for fit in fits) / SUMMED / pixel))
    alike = correlated([fit.distance for fit in fits], 4, side)
    pixels = [np.count_nonzero(fit.distance) for fit in fits]
    variance = sum(float((fit.distance**2).sum()) for fit in fits) / sum(pixels)
    covariance = alike * variance * np.array([fit.inverse for fit in fits])
    place = aligned(value[:, :2], value[:, 2], design, mould)
    matched = np.flatnonzero(place.site >= 0)
    order = matched[np.argsort(place.site[matched])]
    site = place.site[order].astype(np.int64)
    missing = np.setdiff1d(np.arange(design.count), site)
    sd = np.sqrt(np.diagonal(covariance[order], axis1=1, axis2=2))
    _, _, height, radius = value[order].T
    coefficient = np.pad(base.coefficient, (0, 6 - len(base.coefficient)))
    return MadeSurface(
        surface=design.only(site, position=place.position[order], height=height, radius=radius),
        design=design,
        site=site,
        height_sd=np.hypot(sd[:, 2], base.error),
        radius_sd=sd[:, 3],
        position_sd=np.sqrt((sd[:, :2] ** 2).mean(axis=1)),
        tilt=coefficient[1:3],
        bow=coefficient[3:],
        missing=missing,
        roughness=float(np.sqrt(np.mean([fit.sd**2 for fit in fits]))),
        rotation=place.rotation,
        notes=tuple(_notes(design, value[:, :2], place, missing, [*other, *lost])),
    )


def _map(values: ArrayLike, pixel_size: Any, mould: bool) -> Map:
    """Return the checked map; that of a mould upside down."""
    sides = np.broadcast_to(pixel_size, 2) if check.scalar(pixel_size) else pixel_size
    width, height = check.array("pixel_size", sides, shape=(2,), positive=True).tolist()
    try:
        z = np.asarray(np.ma.filled(np.ma.asarray(values, dtype=None).astype(float), np.nan))
    except (TypeError, ValueError):
        raise InvalidInput("height_map is not an array of numbers") from None
    wrong = z.ndim != 2 or min(z.shape) < FEWEST
    must = f"it must have shape (rows, columns), each at least {FEWEST}"
    refuse_if(wrong, f"the map has shape {z.shape}; {must}")
    z = np.where(np.isfinite(z), -z if mould else z, np.nan)
    rows, columns = z.shape
    return Map(z, width * (np.arange(columns) + 0.5), height * (rows - np.arange(rows) - 0.5))


def _levelled(
    surface: Map, design: Surface, bow: bool, mould: bool
) -> tuple[Base, list[Cap], list[tuple[float, float]]]:
    """Return the base plane, initial guesses of the caps, and the centres of other hills [mm]."""
    measurable = design.height > FLATTEST * design.radius
    refuse_if(not measurable.any(), f"design_surface has no summit above {FLATTEST:g} of its radius")
    lowest = float(min(design.height[measurable].min(), design.radius.min()))
    foot = math.sqrt(lowest * (2.0 * float(design.radius.min()) - lowest))
    pixel = max(abs(surface.x[1] - surface.x[0]), abs(surface.y[1] - surface.y[0]))
    side = max(1, min(int(2.0 * foot / ACROSS / pixel), min(surface.z.shape) // FEWEST))
    found, radius = surface.cells(side), float(np.median(design.radius))
    on_hills, starts, other = hills(found, base_plane(found, bow), LOWEST * lowest, radius)
    must = (
        f"the map shows no cap of a radius near {radius:g} mm, but {len(other)} hills of other shapes; check"
    )
    refuse_if(not starts, f"{must} pixel_size, the unit of the heights and mould={not mould}")
    return base_plane(found, bow, ~on_hills), starts, other


def _notes(
    design: Surface, centre: FloatArray, place: Alignment, missing: IntArray, other: list[tuple[float, float]]
) -> Iterator[Note]:
    """Return notes on unmatched summits, missing asperities, and the heights, turn and scale of the map."""
    for what, places in (
        ("caps of the map have no site in the design", centre[place.site < 0].tolist()),
        ("hills of the map are no caps of the design", other),
        ("asperities of the design are missing on the map", design.position[missing].tolist()),
    ):
        if places:
            first = ", ".join(f"({x:.3f}, {y:.3f}) mm" for x, y in places[:NAMED])
            yield Note(f"{len(places)} {what}: {first}" + " and others" * (len(places) > NAMED))
    height = design.height[place.site[place.site >= 0]]
    if place.misfit > FOREIGN * height.std() and place.misfit > FOREIGN_MEAN * height.mean():
        yield Note(
            "the heights of the caps are not those of the design: their errors have the standard deviation "
            f"{place.misfit:g} mm, the designed heights {height.std():g} mm; check the design, and whether "
            "the map shows the mould"
        )
    if not place.decided:
        yield information("the heights do not show how the part was turned or shifted on the map")
    if abs(place.scale - 1.0) > SCALE:
        larger = percent(place.scale - 1.0, "+.2g")
        yield Note(f"distances on the map differ from the design's by {larger}; check pixel_size")
