"""Checks of user input; each error states the argument, its value and the allowed values."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable, Mapping
from itertools import zip_longest
from types import UnionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem.errors import InvalidInput, refuse_if, shown

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Bounds of lengths, loads and moduli. The package multiplies up to five of them, and each product must be a
# normal number in double precision.
SMALLEST, LARGEST = sys.float_info.min**0.2, sys.float_info.max**0.2

# Bounds of lengths that must be positive, and largest magnitude of all lengths [mm]: far below an atom, and
# far above any part, so that lengths may also be given in units a million times larger or smaller.
SHORTEST, LONGEST = 1e-12, 1e8

# Limits of a number by their names: what holds, and its words.
LIMITS: Mapping[str, tuple[Callable[[float, float], bool], str]] = {
    "above": (operator.gt, "greater than"),
    "at_least": (operator.ge, "at least"),
    "at_most": (operator.le, "at most"),
}

# Bounds of Poisson's ratio; a material with 0.5 is incompressible.
POISSON: Mapping[str, Any] = {"at_least": 0.0, "at_most": 0.5}


# Unit of each argument and column of a table that has a unit. A name has one meaning in the whole package;
# NAME_sd is its standard deviation.
UNITS: Mapping[str, str] = {
    name: unit
    for unit, names in {
        "mm": "position height radius pitch width length thickness max_height min_height offset height_step "
        "low high radii step x y rho f separation approach cell contact_radius block_radius cell_radius "
        "alignment_height chord_error indentation r tools radius_range displacement boundary centre "
        "site_position frame sd_position sd_height sd_radius pixel_size blur pinned",
        "mm^2": "rescaled_load rescaled_friction crossover_load crossover_loads load_range area "
        "asperity_area area_before area_sheared smallest_area area_error sheared_area sheared_area_error",
        "N": "load load_min friction_force",
        "N/mm": "adhesion_energy",
        "MPa": "composite_modulus young_modulus shear_strength hardness yield_strength nominal_pressure "
        "nominal_shear_stress",
        "rad": "angle angle_x angle_y tilt rotation rotation_range",
    }.items()
    for name in names.split()
}


def unit_of(name: str) -> str:
    """Return the unit of an argument, such as "mm" for ``radius[3]``, or "1" if it has none."""
    return UNITS.get(name.rpartition(".")[2].partition("[")[0].removesuffix("_sd"), "1")


def with_unit(name: str, value: float) -> str:
    """Return the value of an argument as text, with its unit."""
    return f"{value:g} {unit_of(name)}".removesuffix(" 1")


def number(name: str, value: Any, **limits: float | None) -> float:
    """Return `value` as a finite float, in the unit of the argument `name`.

    The limits are those of `LIMITS`; a limit None is not checked.
    """
    if not isinstance(value, float):
        refuse_if(not scalar(value), "must be a single number", key=name, value=shown(value))
        value = plain(name, value)
    result = float(value)
    refuse_if(not math.isfinite(result), "must be finite", key=name, value=str(result))
    for limit, bound in limits.items():
        holds, must = LIMITS[limit]
        if bound is not None and not holds(result, bound):
            raise InvalidInput(f"must be {must} {with_unit(name, bound)}", key=name, value=result)
    least, most = bounds(name, limits.get("above") == 0.0)
    if result and not least <= abs(result) <= most:
        raise InvalidInput(_magnitude(name, least, most), key=name, value=result)
    return result


def bounds(name: str, positive: bool) -> tuple[float, float]:
    """Return the bounds of the magnitude of an argument that is not 0."""
    length = SHORTEST if positive else 0.0, LONGEST
    return {"1": (0.0, math.inf), "mm": length}.get(unit_of(name), (SMALLEST, LARGEST))


def member(owner: Any, name: str, *, optional: bool = False, **bounds: float) -> None:
    """Replace a member of a frozen dataclass with a checked number; an optional member may be None."""
    value = getattr(owner, name)
    if value is not None or not optional:
        object.__setattr__(owner, name, number(name, value, **bounds))


def _magnitude(name: str, least: float, most: float) -> str:
    limits = f"at most {most:.0e}" if least == 0.0 else f"0, or {least:.0e} to {most:.0e}"
    return f"is outside the range of double precision; it must be {limits} {unit_of(name)} in magnitude"


def integer(name: str, value: Any, *, at_least: int) -> int:
    """Return `value` as an int, which must be at least `at_least`."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.timedelta64))
    if not whole or value < at_least:
        raise InvalidInput(f"must be a whole number of at least {at_least}", key=name, value=shown(value))
    return int(value)


def array(name: str, value: Any, *, shape: tuple[int | None, ...], positive: bool = False) -> FloatArray:
    """Return `value` as a new, read-only, finite float array; None in `shape` means any length > 0."""
    result = np.array(plain(name, value), dtype=np.float64, order="C")
    pairs = zip_longest(shape, result.shape, fillvalue=-1)
    wanted = tuple(m if n is None else n for n, m in pairs)
    words = str(shape).replace("None", "n")
    refuse_if(result.shape != wanted, f"has shape {result.shape}; it must have shape {words}", key=name)
    refuse_if(not result.size, "is empty", key=name)
    refuse_entries(name, result, ~np.isfinite(result), "must be finite")
    if positive:
        refuse_entries(name, result, result <= 0.0, "must be greater than 0")
    (least, most), size = bounds(name, positive), np.abs(result)
    # nothing is divided by entries that may be 0
    beyond = (size > most) | (size < least) if positive else size > most
    if beyond.any():
        refuse_entries(name, result, beyond, _magnitude(name, least, most))
    result.flags.writeable = False
    return result


def loads(name: str, value: Any, *, negative: bool = False) -> FloatArray:
    """Return `value` as an array of loads (k,); negative ones are refused unless `negative`."""
    result = array(name, value, shape=(None,))
    below = result.min() < 0.0 and not negative
    refuse_if(below, f"holds {with_unit(name, result.min())}; loads cannot be negative", key=name)
    tiny = (result != 0.0) & (np.abs(result) < SMALLEST)
    if tiny.any():
        refuse_entries(name, result, tiny, _magnitude(name, SMALLEST, LARGEST))
    return result


def instance(name: str, value: Any, kind: type | UnionType, required: str, *, optional: bool = False) -> None:
    """Refuse a value that is a class or not an instance of `kind`; an optional value may be None."""
    # a protocol is asked last, because it looks for each of its members
    known = kind in type(value).__mro__ or (optional and value is None)
    wrong = not known and (isinstance(value, type) or not isinstance(value, kind))
    refuse_if(wrong, f"must be {required}", key=name, value=shown(value) if wrong else None)


def scalar(value: Any) -> bool:
    """Return whether a value is a single number or quantity, not a list of them."""
    return np.ndim(value) == 0


def increasing(name: str, value: FloatArray, *, zero: bool = False) -> FloatArray:
    """Return `value` if its entries are positive, but for a first `zero`, and strictly increasing."""
    (least, most), first = bounds(name, positive=True), np.arange(len(value)) == zero
    refuse_entries(name, value, first & (value <= 0.0), "must be greater than 0")
    refuse_entries(name, value, first & (value < least), _magnitude(name, least, most))
    words = "does not exceed the one before it; the values must increase"
    refuse_entries(name, value, np.diff(value, prepend=-np.inf) <= 0.0, words)
    return value


def interval(name: str, value: Any) -> tuple[float, float]:
    """Return two positive numbers, of which the second must be the larger."""
    low, high = increasing(name, array(name, value, shape=(2,))).tolist()
    return low, high


def generator(rng: Any) -> np.random.Generator:
    """Return a random generator from a seed, or the generator itself."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        words = "must be a non-negative seed or a numpy Generator"
        raise InvalidInput(words, key="rng", value=shown(rng)) from None


def plain(name: str, value: Any) -> Any:
    """Return a value for numpy; one with another unit than that of `name`, or masked entries, is refused."""
    unit, expected = getattr(value, "units", None) or getattr(value, "unit", None), unit_of(name)
    if unit is not None and str(unit) != expected:
        allowed = "numbers without unit" if expected == "1" else f"plain numbers in {expected}"
        raise InvalidInput(f"is given in {shown(str(unit))}; it must be {allowed}", key=name)
    refuse_if(np.ma.is_masked(value), "has masked entries; leave them out", key=name)
    return value


def array_with_gaps(name: str, value: Any, *, shape: tuple[int | None, ...]) -> FloatArray:
    """Return `value` as `array` does, but allow nan for entries that were not measured."""
    entries = np.array(plain(name, value), dtype=np.float64)
    missing = np.isnan(entries)
    return np.where(missing, np.nan, array(name, np.where(missing, 0.0, entries), shape=shape))


def refuse_entries(name: str, values: FloatArray, wrong: Any, must: str) -> None:
    """Raise InvalidInput for the first entry of `values` at which the mask `wrong` is true."""
    if np.any(wrong):
        place = tuple(np.argwhere(wrong)[0].tolist())
        entry = f"{name}[{', '.join(map(str, place))}]"
        raise InvalidInput(must, key=entry, value=float(values[place]))
