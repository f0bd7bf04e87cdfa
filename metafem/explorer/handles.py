"""The points of a target that the user drags: those of each kind, and the table after a move."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.fields import between, rounded
from metafem.explorer.history import State
from metafem.explorer.scene import COLUMNS, Drawn, Handle, Numbers, Scene, members
from metafem.explorer.table import Table, keys_of
from metafem.files import Specification
from metafem.inversion import Design

# Relative resolution of a dragged value: one pixel of a plot that is a thousand pixels wide.
RESOLUTION = 1e-3

# Relative resolution of a new point on the law of the last design; with fewer digits no surface may reach it.
SNAPPED = 1e-6

# From this number of points on, points that are drawn become a curve that is approximated.
CURVE = 5

# Largest number of points that have handles. With more points, the marks would overlap on the plot, and
# moving a single point would make a spike in the law.
MOST = 200

# Estimate of the largest rescaled load of a surface before there is a design, as a fraction of
# "number of sites x largest height x radius". It is near the largest loads of the paper's surfaces.
BEFORE_ANY_DESIGN = 0.1

# Smallest load difference between pointer and pivot at which a branch is turned through the pointer, as a
# fraction of the load difference between handle and pivot. Closer to the pivot, a small move would change the
# slope far too much.
NEAREST = 0.2

# Members of a target that are loads with a handle of their own, and the member that a handle can remove.
MARKED = ("crossover_load", "crossover_loads", "load_range")
REMOVED = {"range-low": "load_range", "range-high": "load_range", "prefactor": "prefactor"}

# What a drag changes: numbers of the target, and their resolution.
Moved = tuple[Numbers, float]


def _points(scene: Scene) -> Drawn:
    """Return a handle for each point, or none for too many; each moves between its neighbours."""
    load, friction = scene.target.rescaled_load, scene.target.rescaled_friction
    count = len(load)
    handles = [
        Handle(f"point-{i}", *at, "xy", f"point {i + 1} of {count}")
        for i, at in enumerate(zip(load.tolist(), friction.tolist(), strict=True))
    ]
    return handles if count <= MOST else [], (load, friction)


def _band(scene: Scene) -> Drawn:
    """Return the two curves of a band, with a gap between them; its values are edited in the text."""
    target, gap = scene.target, [math.nan]
    load = target.rescaled_load
    curves = np.concatenate([load, gap, load]), np.concatenate([target.lowest, gap, target.highest])
    return [], curves


class Branch(NamedTuple):
    """A straight branch: its slope, its handle, the load about which that turns it, and its ends [mm^2]."""

    slope: float
    load: float
    friction: float
    pivot: float
    low: float
    high: float

    def at(self, load: float) -> float:
        """Return the rescaled friction of the branch at a rescaled load [mm^2]."""
        return self.friction + self.slope * (load - self.load)


def _lines(scene: Scene) -> Drawn:
    """Return handles for the slopes, the crossover loads and the ends of the range, and the branches.

    The handle of a slope is at the middle of its branch. The first branch turns about its intercept, which is
    0 for lines through the origin and otherwise that of the design; each other one about the crossover at its
    start.
    """
    target, branches = scene.target, _branches(scene)
    handles = []
    for i, branch in enumerate(branches):
        words = target.wording.slopes(branch.slope)
        label = f"{words}, branch {i + 1}" if len(branches) > 1 else words
        carried = words.replace("friction coefficient", "μ =").replace("slope ", "slope = ")
        handles.append(Handle(f"slope-{i}", branch.load, branch.friction, "y", label, carried))
    corners = list[tuple[float, float]]()
    for branch in branches:
        if not corners or branch.low > corners[-1][0]:
            if corners and not target.branches:
                corners.append((math.nan, math.nan))  # branches without a load range need not meet
            corners.append((branch.low, branch.at(branch.low)))
        corners.append((branch.high, branch.at(branch.high)))
    load, friction = np.array(corners).T
    for id, at, label in _path(target):
        height = float(np.interp(at, load, friction)) if target.branches else branches[0].at(at)
        handles.append(Handle(id, at, height, "x", label))
    return handles, (load, friction)


def _branches(scene: Scene) -> list[Branch]:
    """Return the branches; the intercepts that the target leaves open are those of the last design."""
    target = scene.target
    slopes = target.slopes if hasattr(target, "slopes") else (target.slope,)
    if not target.branches:
        return [_of_density(scene, i, slopes) for i in range(len(slopes))]
    law = target.curve()
    friction = law.middle
    if law.is_open:
        achieved = scene.achieved(law.load)
        friction = law.law(law.load * max(slopes) if achieved is None else achieved)
    found = []
    for i, (slope, (_, (low, high))) in enumerate(zip(slopes, target.branches, strict=True)):
        middle = 0.5 * (low + high)
        at = float(np.interp(middle, law.load, friction))
        found.append(Branch(slope, middle, at, low if i else 0.0, low, high))
    return found


def _of_density(scene: Scene, i: int, slopes: tuple[float, ...]) -> Branch:
    """Return a branch without a load range: that of the law of the heights' density, or an estimate."""
    target, design, slope = scene.target, scene.design, slopes[i]
    pivot = target.lines[i][1] if i else 0.0
    if design is None or len(design.fits) != len(slopes):
        template = scene.specification.template
        scale = template.count * scene.specification.limits.max_height * float(template.radius.mean())
        crossover = getattr(target, "crossover_load", 0.0)
        load = (0.5 * (crossover or BEFORE_ANY_DESIGN * scale), 1.5 * crossover)[i]
        friction = slope * load + (slopes[0] - slope) * crossover * i
        return Branch(slope, load, friction, pivot, pivot, 2.0 * load - pivot)
    branch, fit = design.fits[i]
    low, high = branch.load_range
    load = 0.5 * (low + high)
    if branch.intercept is not None:
        friction = branch.intercept + slope * load
    else:
        turned = (slope - branch.slope) * (load - target.lines[i][1])
        friction = fit.intercept + fit.slope * load + turned
    return Branch(slope, load, friction, pivot, low, high)


def _path(target: Any) -> list[tuple[str, float, str]]:
    """Return handle id, rescaled load [mm^2] and label of all crossovers and range ends, by load."""
    crossover = getattr(target, "crossover_load", None)
    pairs = getattr(target, "crossover_loads", () if crossover is None else ((crossover, crossover),))
    found = []
    for i, (end, start) in enumerate(pairs):
        words = "crossover load" if len(pairs) == 1 else f"crossover load {i + 1}"
        if end == start:
            found.append((f"crossover-{i}", end, words))
        else:
            found.append((f"crossover-{i}-end", end, f"{words}, end of branch {i + 1}"))
            found.append((f"crossover-{i}-start", start, f"{words}, start of branch {i + 2}"))
    if target.load_range is None:
        return found
    low, high = target.load_range
    first, last = "smallest load of the range", "largest load of the range"
    return [("range-low", low, first), *found, ("range-high", high, last)]


def _power(scene: Scene) -> Drawn:
    """Return handles for the exponent, for the prefactor if the target has one, and for the ends.

    The handle of the exponent lies halfway between the middle and the upper end of the range; both midpoints
    are taken in the logarithm of the load. Dragging this handle turns the law about the middle.
    """
    target, (low, high) = scene.target, scene.target.load_range
    law, middle, prefactor = target.curve(), math.sqrt(low * high), target.prefactor
    if prefactor is None:  # that of the last design
        achieved = scene.achieved(law.load)
        prefactor = 1.0 if achieved is None else float(law.law(achieved)[0] / law.free[0, 0])
    places = [("exponent", math.sqrt(middle * high), "y", f"exponent {target.exponent:.4g}")]
    if target.prefactor is not None:
        places.append(("prefactor", middle, "y", f"prefactor {target.prefactor:.4g}"))
    places.append(("range-low", low, "x", "smallest load of the range"))
    places.append(("range-high", high, "x", "largest load of the range"))
    handles = [Handle(id, at, float(prefactor * at**target.exponent), *rest) for id, at, *rest in places]
    return handles, (law.load, prefactor * law.load**target.exponent)


DRAWN = {
    "operating-points": _points,
    "sampled": _points,
    "linear": _lines,
    "bilinear": _lines,
    "multilinear": _lines,
    "power": _power,
    "band": _band,
}


def scene_of(state: State, specification: Specification | None, design: Design | None) -> Scene:
    """Return the target of a state with its handles.

    `design` is the last design, which supplies the intercepts that the target leaves open. Every step of a
    drag must use the same scene: a later design has other intercepts, so the result would depend on the path
    of the pointer.

    Raises
    ------
    InvalidInput
        If there is no specification because the state has problems.

    Examples
    --------
    >>> from metafem.files import demo_text, of_table, parsed
    >>> text = demo_text("operating-points")
    >>> scene = scene_of(State(text), parsed(text), None)
    >>> [handle.load for handle in scene.handles()]
    [0.144, 0.336, 0.649]
    >>> of_table(moved(scene, "point-1", 0.40004, 1.9)).target.rescaled_load
    array([0.144, 0.4  , 0.649])
    """
    if specification is None:
        raise InvalidInput("the specification has problems; correct them before the law is dragged")
    return Scene(state, specification, design, DRAWN[state.table["target"]["kind"]])


def moved(scene: Scene, id: str, load: float, friction: float, resolution: float = RESOLUTION) -> Table:
    """Return the table after a handle has moved to a rescaled load and friction [mm^2].

    Values keep their units. The load of a handle stays between the loads of its neighbours, and so does the
    friction of a point.

    Raises
    ------
    InvalidInput
        If there is no such handle, or for values that are negative or not finite.
    """
    _refuse_negative(load=load, friction=friction)
    handle = _handle(scene, id)
    move = {"point": _placed, "slope": _turned, "exponent": _bent, "prefactor": _bent}
    by = _slid if handle.moves == "x" else move[id.partition("-")[0]]
    return scene.written(*by(scene, handle, (load, friction), resolution))


def _slid(scene: Scene, handle: Handle, at: tuple[float, float], resolution: float) -> Moved:
    """Return the crossovers and the load range with one load moved between its neighbours."""
    given = members(scene.target, MARKED)
    path = np.unique(np.hstack([np.ravel(value) for value in given.values()])).tolist()
    i, path = path.index(handle.load), [0.0, *path, math.inf]
    placed, fine = between(at[0], path[i], path[i + 2], resolution)
    placed = placed or resolution * handle.load
    return {name: _replaced(value, handle.load, placed) for name, value in given.items()}, fine


def _replaced(value: Any, old: float, new: float) -> Any:
    if isinstance(value, tuple):
        return tuple(_replaced(each, old, new) for each in value)
    return new if value == old else value


def _turned(scene: Scene, handle: Handle, at: tuple[float, float], resolution: float) -> Moved:
    """Return the slopes with one branch turned about its pivot through a load and friction [mm^2]."""
    i, branches = _index(handle.id), _branches(scene)
    branch, slopes = branches[i], [each.slope for each in branches]
    near = (at[0] - branch.pivot) / (branch.load - branch.pivot) < NEAREST
    run = (branch.load if near else at[0]) - branch.pivot
    slopes[i] = max((at[1] - branch.at(branch.pivot)) / run, resolution * slopes[i])
    return {"slopes": slopes} if hasattr(scene.target, "slopes") else {"slope": slopes[0]}, resolution


def _bent(scene: Scene, handle: Handle, at: tuple[float, float], resolution: float) -> Moved:
    """Return exponent and prefactor of the law through a load and friction; it turns about its middle."""
    target, middle = scene.target, math.sqrt(math.prod(scene.target.load_range))
    friction = max(at[1], resolution * handle.friction)
    try:
        if handle.id == "prefactor":
            return {"prefactor": friction / middle**target.exponent}, resolution
        level = handle.friction * (middle / handle.load) ** target.exponent
        load = at[0] if at[0] > middle else handle.load
        exponent = rounded(max(math.log(friction / level) / math.log(load / middle), resolution), resolution)
        bent = {"exponent": exponent, "prefactor": level / middle**exponent}
    except ArithmeticError:  # a power overflows double precision, or the range has no middle
        words = "the law cannot be moved by hand over this range of loads; change the keys of [target]"
        raise InvalidInput(f"target.load_range: {words}") from None
    return {name: bent[name] for name in bent if getattr(target, name) is not None}, resolution


def _placed(scene: Scene, handle: Handle, at: tuple[float, float], resolution: float) -> Moved:
    """Return the points with one point moved between its neighbours."""
    return _between(_columns(scene), _index(handle.id), at, resolution)


def _between(columns: Numbers, i: int, at: tuple[float, float], resolution: float) -> Moved:
    finest = resolution
    for numbers, value in zip(columns.values(), at, strict=False):
        low, high = [0.0, *numbers][i], [*numbers, math.inf][i + 1]
        if low >= high:  # the friction of noisy samples may decrease
            low, high = 0.0, math.inf
        placed, fine = between(value, low, high, resolution)
        numbers[i] = placed or resolution * numbers[i]  # a single point must not reach 0
        finest = min(finest, fine)
    return columns, finest


def _columns(scene: Scene) -> Numbers:
    """Return loads and frictions, and the other columns that the table has."""
    optional = {"weight", "relative_error"} - scene.section.keys()
    return members(scene.target, [name for name in COLUMNS if name not in optional])


def _index(id: str) -> int:
    """Return the number at the end of the id of a handle."""
    return int(id.rpartition("-")[2])


def added(scene: Scene, load: float, friction: float, near: float = 0.0) -> Table:
    """Return the table with one more point of the target at a rescaled load and friction [mm^2].

    If its friction differs by at most `near` from that of the law of the last design, the point is on this
    law.

    Raises
    ------
    InvalidInput
        If the target does not consist of points, or for values that are negative or not finite.
    """
    _refuse_negative(load=load, friction=friction)
    words = (
        f"a {scene.kind} law is not given by points; choose the kind operating-points or sampled to add some"
    )
    refuse_if(DRAWN[scene.kind] is not _points, words)
    achieved, resolution = scene.achieved(np.array([load])) if near > 0.0 and load > 0.0 else None, RESOLUTION
    if achieved is not None and abs(achieved[0] - friction) <= near:
        friction, resolution = float(achieved[0]), SNAPPED
    columns = _columns(scene)
    loads = columns["rescaled_load"]
    count, i = len(loads), sum(other <= load for other in loads)
    for name, entries in columns.items():
        entries.insert(i, 1.0 if name == "weight" else entries[min(i, count - 1)])
    numbers, fine = _between(columns, i, (load, friction), resolution)
    drawn_by_hand = scene.kind == "operating-points" and len(numbers["rescaled_load"]) >= CURVE
    return scene.written(numbers, fine, "sampled" if drawn_by_hand else "")


def removed(scene: Scene, id: str) -> Table:
    """Return the table without a point or an optional parameter of the target.

    Raises
    ------
    InvalidInput
        If there is no such handle; for the last remaining point; and for the handle of a required parameter.
    """
    handle = _handle(scene, id)
    if DRAWN[scene.kind] is _points:
        columns = _columns(scene)
        refuse_if(len(scene.handles()) == 1, "the last point cannot be removed; a target needs at least one")
        for entries in columns.values():
            del entries[_index(handle.id)]
        return scene.written(columns, RESOLUTION)
    optional = [key["name"] for key in keys_of("target", scene.kind) if key["optional"]]
    words = f"a {scene.kind} law needs what this handle changes; it cannot be removed"
    refuse_if(REMOVED.get(id) not in optional, words)
    return scene.written({REMOVED[id]: None}, RESOLUTION)


def _handle(scene: Scene, id: str) -> Handle:
    """Return a handle, or raise InvalidInput if the target does not have it."""
    for handle in scene.handles():
        if handle.id == id:
            return handle
    raise InvalidInput(f'the target has no handle "{id:.40}"')


def _refuse_negative(**at: float) -> None:
    for name, value in at.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidInput(f"{name} = {value:g} mm^2 must be a finite number of at least 0")
