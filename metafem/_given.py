"""Values that a user passed in: conversion to plain numbers, and how errors print them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from metafem.errors import InvalidInput

# The unit of each argument that has one. A name means the same in the whole package.
UNITS: Mapping[str, str] = {
    name: unit
    for unit, names in {
        "mm": (
            *("position", "height", "radius", "pitch", "width", "length", "thickness", "max_height"),
            *("min_height", "offset", "height_step", "height_sd", "low", "high", "radii", "step"),
            *("separation", "approach", "cell", "contact_radius", "block_radius", "cell_radius"),
            *("alignment_height", "chord_error", "indentation", "r", "tools", "range"),
            *("displacement", "sliding_range", "boundary", "centre", "site_position", "frame"),
            *("radius_sd", "position_sd", "pixel_size", "blur", "pinned"),
        ),
        "mm^2": (
            *("rescaled_load", "rescaled_friction", "crossover_load", "crossover_loads", "load_range"),
            *("area", "area_sd", "asperity_area", "asperity_area_sd"),
            *("area_before", "area_sheared", "expected_area", "smallest_area"),
        ),
        "N": ("load", "load_min", "friction_force", "load_sd", "friction_force_sd"),
        "N/mm": ("adhesion_energy",),
        "MPa": ("composite_modulus", "young_modulus", "shear_strength", "hardness", "yield_strength"),
        "rad": ("angle", "angle_x", "angle_y", "angle_sd", "tilt", "rotation", "rotation_range"),
    }.items()
    for name in names
}

# Kinds of arrays that are refused, by numpy's letter of the kind.
FOREIGN = {
    "b": "a truth value",
    "c": "complex",
    "M": "a date",
    "m": "a duration",
    "S": "bytes",
    "U": "a text",
    "V": "a structured array",
}


def unit_of(name: str) -> str:
    """Return the unit of an argument, such as "mm" of ``radius[3]``, or "1"."""
    return UNITS.get(name.rpartition(".")[2].partition("[")[0], "1")


@dataclass(frozen=True)
class ErrorNames:
    """How errors name arguments, entries and numbers: as in Python, or as in the file that was read.

    `units` holds the unit in which a quantity was written and the size of that unit in the package's unit;
    `lines` holds the line number of each entry in the file, `names` the file's names of arguments, and
    `file` the name of the file. `places` holds the place of each entry where they are of several files.
    """

    section: str = ""
    units: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    file: str = ""
    lines: tuple[int, ...] = ()
    names: Mapping[str, str] = field(default_factory=dict)
    places: tuple[str, ...] = ()

    def number(self, name: str, value: float) -> str:
        """Return a number in the unit in which its quantity was written."""
        if not self.units:
            return f"{value:g}"
        name = name.partition("[")[0]
        default = unit_of(name), 1.0
        unit, size = self.units.get(f"{self.section}.{name}") or self.units.get(name, default)
        return f"{float(value) / size:g} {unit}".removesuffix(" 1").rstrip()

    def label(self, name: str) -> str:
        """Return the file's name of an argument or of an entry, such as ``radius[3]``."""
        base, bracket, index = name.partition("[")
        if (self.lines or self.places) and bracket:
            entry = int(index.rstrip("]").partition(",")[0])
            place = self.places[entry] if self.places else f"{self.file}, line {self.lines[entry]}"
            return f"{place}: {self.names.get(base, base)}"
        return self.names.get(base, base) + bracket + index


_NAMES: ContextVar[ErrorNames] = ContextVar("_NAMES", default=ErrorNames())  # noqa: B039 - frozen


@contextmanager
def error_section(section: str) -> Iterator[None]:
    """Make errors raised in the body refer to a section of the file."""
    with error_names(replace(_NAMES.get(), section=section)):
        yield


@contextmanager
def error_names(names: ErrorNames) -> Iterator[None]:
    """Make errors raised in the body use these names and units."""
    token = _NAMES.set(names)
    try:
        yield
    finally:
        _NAMES.reset(token)


def named_by_file() -> bool:
    """Whether errors name arguments as in a file, where values are lists."""
    return _NAMES.get() != ErrorNames()


def formatted(name: str, value: float) -> str:
    """Return the number of an argument as errors print it."""
    return _NAMES.get().number(name, value)


def label(name: str) -> str:
    """Return the name of an argument, or of an entry such as ``radius[3]``, as errors print it."""
    return _NAMES.get().label(name)


def shown(value: Any, most: int = 60) -> str:
    """Return any value on one line, for an error."""
    if isinstance(value, (str, bytes)):
        value = value[: 2 * most]
    try:
        text = repr(value)
    except Exception:  # an object of another library, or an integer with too many digits
        text = f"{'an' if type(value).__name__[0] in 'aeiou' else 'a'} {type(value).__name__}"
    return printable(" ".join(text.split()), most)


def printable(text: str, most: int = 200) -> str:
    """Return a text on one line: unprintable characters are escaped, and a long text is cut."""
    cut = text if len(text) <= most else text[: most - 1] + "…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in cut)


def plain(name: str, value: Any) -> Any:
    """Return a value as plain numbers in the unit that belongs to its name.

    A quantity of pint, astropy or a similar library is converted by its own method. A value that has a unit
    but no such method is refused, and so are masked entries and units of another dimension. Anything else
    that is not a number raises TypeError with what it is.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    if isinstance(value, (list, tuple, range)):
        return [v if type(v) in (float, int) else plain(f"{name}[{i}]", v) for i, v in enumerate(value)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a lossy conversion raises a warning
        return _plain(name, value)


def _plain(name: str, value: Any) -> Any:
    if type(value) is not np.ndarray and not isinstance(value, np.generic):
        value = _without_unit(name, value)
    if isinstance(value, np.ma.MaskedArray):
        masked = np.flatnonzero(np.ma.getmaskarray(value))
        if masked.size:
            raise InvalidInput(f"{name} is masked at entry {masked[0]}; leave out or fill masked entries")
        value = np.ma.getdata(value)
    if value is None or isinstance(value, (str, bytes, bool, complex)):
        raise TypeError(f"{name} is {shown(value)}")
    array = np.asarray(value)
    if array.dtype.kind in FOREIGN:
        raise TypeError(f"{name} is {FOREIGN[array.dtype.kind]}")
    if array.dtype.kind != "O":
        return array if array.ndim else array[()]
    if array.ndim == 0:
        return float(value)
    entries = [plain(f"{name}[{i}]", member) for i, member in enumerate(array.flat)]
    return np.array(entries, dtype=np.float64).reshape(array.shape)


def _without_unit(name: str, value: Any) -> Any:
    """Return the numbers of a quantity, recognised by its attributes, in the unit of the name."""
    expected = unit_of(name)
    inner = getattr(value, "data", None)
    if hasattr(inner, "to") and hasattr(inner, "units"):  # a labelled array that wraps a quantity
        value = inner
    for numbers, unit in (("magnitude", "units"), ("value", "unit")):
        if hasattr(value, unit) and hasattr(value, numbers) and hasattr(value, "to"):
            try:
                return getattr(value.to("" if expected == "1" else expected), numbers)
            except Exception:  # each library raises its own errors
                raise _wrong_unit(name, getattr(value, unit), expected) from None
    text = getattr(value, "units", None) or getattr(value, "unit", None)
    if isinstance(text, str) and text != expected:
        raise _wrong_unit(name, text, expected)
    return value


def _wrong_unit(name: str, unit: Any, expected: str) -> InvalidInput:
    allowed = "a number without unit" if expected == "1" else f"{expected}, or a plain number in {expected}"
    return InvalidInput(f"{name} is given in {shown(str(unit))}; it must be {allowed}")
