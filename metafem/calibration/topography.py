"""Made surface on a map of heights: level it, fit spheres to the caps, match them to the design, errors."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polygrid2d
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from xarray import DataArray

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent
from metafem.calibration.contact_table import listed
from metafem.calibration.sites import FEWEST as FEWEST_SITES
from metafem.calibration.sites import complex_points, matches, real_points
from metafem.caps import SPHERE
from metafem.errors import refuse_if
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.progress import each as told
from metafem.surface import Surface

# Ratio of the standard deviation of a normal variable to the median of its absolute value.
SD_OF_MEDIAN = 1.4826

# Distance from the base or from a sphere beyond which a value is an outlier, in standard deviations. For a
# normal variable, one value in 150,000 is farther away.
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
# initial guess of a sphere has the area of the cells above UPPER of the height of a hill, without its foot.
# RADIUS_FACTOR is the largest ratio between its radius and that of the design.
CELLS, UPPER, RADIUS_FACTOR = 8, 0.3, 2.0

# Powers of y and x of the base. Largest number of fits to it, and smallest number of cells, five for each of
# six unknowns.
POWERS, STEPS, BASE_CELLS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)), 25, 30

# Largest slope at which a cap is used [-], 45 degrees; microscopes do not see steeper flanks. Lowest fraction
# of a cap's height, which the fit leaves out because tool and microscope round the foot.
STEEPEST, FOOT = 1.0, 0.1

# Number of Gauss-Newton steps to a sphere, each with the pixels near the one before; four suffice if the
# guess is wrong by a tenth of the radius. Smallest number of pixels of a cap, five for each unknown.
ROUNDS, PIXELS = 8, 20

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


def cells_of(surface: DataArray, side: int) -> DataArray:
    """Return the map of the means over cells of `side` x `side` pixels; incomplete cells are left out."""
    blocks: Any = {"y": side, "x": side, "boundary": "trim"}
    share = surface.notnull().coarsen(**blocks).mean()
    return surface.coarsen(**blocks).mean().where(share >= MEASURED)


def base(found: DataArray, free: Any = True) -> tuple[FloatArray, float]:
    """Return the coefficients of the base (3, 3), fitted to the mean heights of the `free` cells, and the
    robust standard deviation of the cells about it [mm].

    Least squares are repeated over the cells within 4.5 robust standard deviations of the base. Only the
    cells below it determine this standard deviation, because caps and dust lie above it.
    """
    known = np.isfinite(found.values) & free
    u, v = (axis[known] for axis in np.meshgrid(found.x, found.y))
    matrix, values = np.array([v**i * u**j for i, j in POWERS]).T, found.values[known]
    inside, before = np.ones(len(values), dtype=bool), np.zeros(0, dtype=bool)
    for _ in range(STEPS):
        few = f"the map holds no base plane: {inside.sum()} cells with heights between its summits lie on one"
        refuse_if(inside.sum() < BASE_CELLS, f"{few}; at least {BASE_CELLS} are needed")
        fit = np.linalg.lstsq(matrix[inside], values[inside], rcond=None)[0]
        if np.array_equal(before, inside):
            break
        residual = values - matrix @ fit
        middle = float(np.median(residual[inside]))
        sd = SD_OF_MEDIAN * float(np.median(middle - residual[residual <= middle]))
        before, inside = inside, np.abs(residual - middle) <= OUTLIER * sd
    coefficient = np.zeros((3, 3))
    coefficient[tuple(np.transpose(POWERS))] = fit
    return coefficient, sd


def without(found: DataArray, coefficient: FloatArray) -> DataArray:
    """Return the map without a base."""
    return found.copy(data=found.values - polygrid2d(found.y.values, found.x.values, coefficient))


def correlated(residuals: Sequence[FloatArray], parameters: int, side: int) -> float:
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


def part(height: float, radius: float) -> float:
    """Return the radius [mm] of the circle within which a cap is above its foot and not too steep."""
    above = (1.0 - FOOT) * height
    wide = max(above * (2.0 * radius - above), 0.0)
    return min(math.sqrt(wide), STEEPEST / math.hypot(1.0, STEEPEST) * radius)


def hills(levelled: DataArray, lowest: float, radius: float) -> tuple[NDArray[np.bool_], list[FloatArray]]:
    """Return a mask of the cells on hills above `lowest`, with a margin, and guesses of x, y, height and
    radius of the caps; `radius` is that of the design [mm].
    """
    from skimage.measure import regionprops

    heights = np.nan_to_num(levelled.values)
    high = heights > lowest
    # close holes in the flanks
    closed = ndimage.binary_closing(high, iterations=2) | high
    label, _ = ndimage.label(closed, np.ones((3, 3)))
    x, y = levelled.x.values, levelled.y.values
    area, guesses = abs((x[1] - x[0]) * (y[1] - y[0])), []
    for region in regionprops(label, heights):  # type: ignore[no-untyped-call]
        rows, columns = region.coords.T
        values = heights[rows, columns]
        upper = values > UPPER * values.max()
        # a sphere is rho^2 = d (2 R - d) wide at a depth d below its summit
        depth = (1.0 - UPPER) * values.max()
        wide = 0.5 * (upper.sum() * area / math.pi / depth + depth)
        if upper.sum() >= CELLS and 1.0 / RADIUS_FACTOR <= wide / radius <= RADIUS_FACTOR:
            middle = x[columns[upper]].mean(), y[rows[upper]].mean()
            guesses.append(np.array([*middle, values.max(), wide]))
    # margin: one cell for the foot of a hill below the threshold, and one for the closing
    return ndimage.binary_dilation(closed, np.ones((3, 3)), iterations=2), guesses


def fitted(levelled: DataArray, cap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return x, y, height and radius of the sphere fitted to one cap, the inverse of their normal matrix, and
    the distances of the pixels, 0 where not used; None if the cap is not found.

    The fit minimises the squared distances from the sphere, integrated over the area of the sphere. Equal
    areas of a rough surface contain equal information, so the weight of a pixel is the inverse of the cosine
    of the slope. Pixels at distances above 4.5 robust standard deviations are left out, with their
    neighbours.
    """
    beside = 1.2 * part(cap[2], cap[3]) * np.array([-1.0, 1.0])
    window = levelled.sel(x=slice(*cap[0] + beside), y=slice(*cap[1] - beside))
    x, y = np.meshgrid(window.x, window.y)
    for _ in range(ROUNDS):
        if not 0.0 < cap[2] < 2.0 * cap[3]:
            return None
        radius = cap[3]
        dx, dy, dz = x - cap[0], y - cap[1], window.values - cap[2] + radius
        distance = np.sqrt(dx**2 + dy**2 + dz**2) - radius
        within = np.isfinite(dz) & (dx**2 + dy**2 <= part(cap[2], radius) ** 2)
        if not within.any():
            return None
        sd = SD_OF_MEDIAN * float(np.median(np.abs(distance[within])))
        far = within & (np.abs(distance) > OUTLIER * max(sd, RESOLUTION * radius))
        used = within & ~(ndimage.binary_dilation(far, iterations=BESIDE) if far.any() else far)
        if used.sum() < PIXELS:
            return None
        # derivatives of z = h - R + q with q = sqrt(R^2 - rho^2) with respect to x, y, h and R
        q = np.sqrt(radius**2 - dx[used] ** 2 - dy[used] ** 2)
        matrix = np.array([dx[used] / q, dy[used] / q, np.ones(q.size), radius / q - 1.0])
        inverse = np.linalg.inv((matrix * q / radius) @ matrix.T)
        cap = cap + inverse @ (matrix @ distance[used])
    return cap, inverse, np.where(used, distance, 0.0)


def aligned(
    centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool
) -> tuple[IntArray, FloatArray, complex, bool]:
    """Return the site of each summit, -1 for none, its position in the design's coordinates, the factor of
    the map (its scale, and rotation of the part), and whether the heights decide.

    Of the quarter turns and shifts with the largest number of matched summits, the one that fits the heights
    is used.
    """
    words = f"the map shows {len(centre)} caps and the design has {design.count} asperities"
    few = f"{words}; at least {FEWEST_SITES} of each are needed to match them"
    refuse_if(min(len(centre), design.count) < FEWEST_SITES, few)
    points, sites = complex_points(centre), complex_points(design.position, mirrored)
    poses = matches(points, sites, [0.5 * math.pi * quarter for quarter in range(4)], TURN)
    misfits = [float((height - design.height[site])[site >= 0].std()) for _, _, site in poses]
    near = [pose for pose, misfit in zip(poses, misfits, strict=True) if misfit <= DECIDED * min(misfits)]
    factor, _, site = near[0]
    on = site >= 0
    # a rigid motion: the scale of the map is kept
    away = (points - points[on].mean()) * abs(factor) / factor
    moved = real_points(away + sites[site[on]].mean()) * [-1.0 if mirrored else 1.0, 1.0]
    return site, moved, factor, len(near) == 1


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
    mould: bool = False,
) -> MadeSurface:
    """Return the made surface: heights, radii and positions of the asperities on a map of heights.

    The base, a plane with bow, is fitted between the caps and subtracted, which also removes the bow of a
    free part. A sphere ``z = h - R + sqrt(R^2 - rho^2)`` is fitted to the part of each cap that belongs to
    the upper nine tenths of its height and has a slope below 1, because this large part has the most
    information. For roughness with the standard deviation s and the covariance ``s^2 exp(-r^2/l^2)`` on a
    circle of radius a, the standard errors are ``2 s l/a`` for the height, ``4 sqrt(3) s l R^2/a^3`` for the
    radius and ``2 s l R/a^2`` for each coordinate, to first order in a/R and l/a. No unbiased estimate is
    better by more than terms of order l/a. For caps 0.05 to 0.27 mm high with R = 0.526 mm and an arithmetic
    roughness of 1.2 um, the root mean square error of the heights is at most 0.1 um up to l = 12 um. The
    returned standard errors are computed from the correlation of the measured residuals. They leave out that
    of the base, which adds 1 to 3 %.

    Parameters
    ----------
    height_map : array_like, (rows, columns)
        Heights [mm], nan or masked where not measured. As in an image, columns run along x and rows downwards
        along -y; those that SurfaceTopography reads are ``topography.to_unit("mm").heights().T[::-1]``.
    pixel_size : float or (float, float)
        Distance between the centres of neighbouring pixels [mm], or the two distances along x and y.
    design_surface : Surface
        Designed surface, with the sites and the size of the caps.
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
    surface = _map(height_map, pixel_size, mould)
    with doing("measuring the surface"):
        levelled, guesses = _levelled(surface, design, mould)
        every = [fitted(levelled, guess) for guess in told("fitting spheres: summit", guesses)]
    fits = [fit for fit in every if fit]
    refuse_if(not fits, "the map shows no cap that can be measured: its hills are no spheres")
    caps, inverses, distances = zip(*fits, strict=True)
    x, y, height, radius = np.array(caps).T
    sd, roughness = _errors(caps, inverses, distances, float(abs(surface.x[1] - surface.x[0])))
    site, position, factor, decided = aligned(np.column_stack([x, y]), height, design, mould)
    order = np.argsort(site)[np.count_nonzero(site < 0) :]
    found = site[order].astype(np.int64)
    missing = np.setdiff1d(np.arange(design.count), found)
    return MadeSurface(
        surface=design.only(found, position=position[order], height=height[order], radius=radius[order]),
        design=design,
        site=found,
        height_sd=sd[order, 2],
        radius_sd=sd[order, 3],
        position_sd=np.sqrt((sd[order, :2] ** 2).mean(axis=1)),
        missing=missing,
        roughness=roughness,
        rotation=float(np.angle(factor)),
        notes=tuple(_notes(design, len(guesses) - len(order), missing, decided, abs(factor) - 1.0)),
    )


def _map(height_map: ArrayLike, pixel_size: Any, mould: bool) -> DataArray:
    """Return the checked map; that of a mould upside down."""
    sides = np.broadcast_to(pixel_size, 2) if check.scalar(pixel_size) else pixel_size
    width, height = check.array("pixel_size", sides, shape=(2,), positive=True).tolist()
    heights = check.array_with_gaps("height_map", np.ma.filled(height_map, np.nan), shape=(None, None))
    small = f"the map has shape {heights.shape}; it must have at least {FEWEST} rows and columns"
    refuse_if(min(heights.shape) < FEWEST, small)
    z = -heights if mould else heights
    rows, columns = z.shape
    x, y = width * (np.arange(columns) + 0.5), height * (rows - np.arange(rows) - 0.5)
    return DataArray(z, {"y": y, "x": x})


def _levelled(surface: DataArray, design: Surface, mould: bool) -> tuple[DataArray, list[FloatArray]]:
    """Return the map without its base, and initial guesses of the caps."""
    must = f"must be {SPHERE!r}, because spheres are fitted to the map"
    refuse_if(design.cap != SPHERE, must, key="design_surface.cap", value=repr(design.cap))
    measurable = design.height > FLATTEST * design.radius
    refuse_if(not measurable.any(), f"design_surface has no summit above {FLATTEST:g} of its radius")
    lowest = float(min(design.height[measurable].min(), design.radius.min()))
    foot = math.sqrt(lowest * (2.0 * float(design.radius.min()) - lowest))
    pixel = max(abs(float(axis[1] - axis[0])) for axis in (surface.x, surface.y))
    side = max(1, min(int(2.0 * foot / ACROSS / pixel), min(surface.shape) // FEWEST))
    cells, radius = cells_of(surface, side), float(np.median(design.radius))
    fit, sd = base(cells)
    on_hills, guesses = hills(without(cells, fit), max(ABOVE * sd, LOWEST * lowest), radius)
    must = f"the map shows no cap of a radius near {radius:g} mm; check pixel_size, the unit of the heights"
    refuse_if(not guesses, f"{must} and mould={not mould}")
    return without(surface, base(cells, ~on_hills)[0]), guesses


def _errors(
    caps: Sequence[FloatArray], inverses: Sequence[FloatArray], distances: Sequence[FloatArray], pixel: float
) -> tuple[FloatArray, float]:
    """Return the standard deviations of x, y, height and radius of caps, (n, 4), and the roughness [mm]."""
    side = max(1, round(min(part(cap[2], cap[3]) for cap in caps) / SUMMED / pixel))
    pixels = sum(np.count_nonzero(distance) for distance in distances)
    variance = sum(float((distance**2).sum()) for distance in distances) / pixels
    independent = variance * correlated(distances, 4, side)
    return np.sqrt(independent * np.diagonal(inverses, axis1=1, axis2=2)), math.sqrt(variance)


def _notes(design: Surface, unknown: int, missing: IntArray, decided: bool, scale: float) -> Iterator[Note]:
    """Yield notes on unmatched caps, missing asperities, and the turn and the scale of the map."""
    if unknown:
        yield Note(f"{unknown} caps of the map have no site in the design, or are no spheres")
    if len(missing):
        first = listed(f"({x:.3f}, {y:.3f}) mm" for x, y in design.position[missing].tolist())
        yield Note(f"{len(missing)} asperities of the design are missing on the map: {first}")
    if not decided:
        yield information("the heights do not show how the part was turned or shifted on the map")
    if abs(scale) > SCALE:
        larger = percent(scale, "+.2g")
        yield Note(f"distances on the map differ from the design's by {larger}; check pixel_size")
