"""The public names of metafem: on which page each stands, and which members of a class are shown."""

from __future__ import annotations

import importlib
import inspect
import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from functools import cache, cached_property
from types import ModuleType
from typing import Any

# The pages, and for modules whose other names are internal, the names that are explained. None: all.
PAGES: dict[str, tuple[str, ...] | None] = {
    "metafem": None,
    "metafem.contact": None,
    "metafem.substrate": None,
    "metafem.models": ("Model", "ModelError", "Curve", "ContactField", "Sensitivity"),
    "metafem.prediction": ("BranchFit",),
    "metafem.fe": None,
    "metafem.studies": None,
    "metafem.calibration": None,
    "metafem.files": ("Specification", "PartOptions"),
    "metafem.report": ("page",),
    "metafem.progress": None,
    "metafem.reference": None,
}

# Names of types that are no part of metafem.
KNOWN_TYPES = {
    *("Any", "None", "Self", "Callable", "Iterator", "Sequence", "Mapping", "Iterable", "True", "False"),
    *("ArrayLike", "FloatArray", "IntArray", "Values", "Generator", "Path", "Axes", "DataFrame", "Dataset"),
}  # fmt: skip


@dataclass(frozen=True)
class Member:
    """A method or a property of a class."""

    name: str
    kind: str
    function: Callable[..., Any]
    docstring: str

    @property
    def is_long(self) -> bool:
        """Whether its docstring has more than a first paragraph."""
        return "\n\n" in self.docstring


@dataclass(frozen=True)
class Entry:
    """A public class or function."""

    name: str
    value: Any

    @property
    def docstring(self) -> str:
        """Its own docstring."""
        return inspect.cleandoc(self.value.__doc__ or "")

    @property
    def kind(self) -> str:
        """What it is in one word."""
        if not inspect.isclass(self.value):
            return "function"
        kinds = {Warning: "warning", BaseException: "exception", object: "class"}
        return next(word for kind, word in kinds.items() if issubclass(self.value, kind))

    @property
    def constants(self) -> list[tuple[str, str]]:
        """Names and values of an enumeration."""
        if not (inspect.isclass(self.value) and issubclass(self.value, Enum)):
            return []
        return [(each.name, str(each.value)) for each in self.value]

    @property
    def is_called(self) -> bool:
        """Whether users call it: a function, or a class whose parameters are explained or that has none."""
        if self.kind == "function" or "\nParameters\n---" in self.docstring:
            return True
        return self.kind == "class" and not (self.is_abstract or inspect.signature(self.value).parameters)

    @property
    def is_abstract(self) -> bool:
        """Whether it is a class that only states what others offer."""
        return inspect.isabstract(self.value) or bool(getattr(self.value, "_is_protocol", False))


@dataclass(frozen=True)
class Page:
    """A module, with its public names in groups."""

    name: str
    groups: dict[str, list[Entry]] = field(default_factory=dict)

    @cached_property
    def module(self) -> ModuleType:
        """The module itself."""
        return importlib.import_module(self.name)

    @property
    def docstring(self) -> str:
        """The docstring of the module."""
        return inspect.getdoc(self.module) or ""

    @property
    def elsewhere(self) -> list[str]:
        """Names of the module that stand on a page before."""
        own = {entry.name for entry in self.entries}
        listed = () if PAGES[self.name] else getattr(self.module, "__all__", ())
        return [n for n in listed if n not in own and not inspect.ismodule(getattr(self.module, n))]

    @property
    def entries(self) -> list[Entry]:
        """All names."""
        return [entry for group in self.groups.values() for entry in group]


@cache
def pages() -> dict[str, Page]:
    """Return all pages; a name that stands on one page is left out on those behind it."""
    found: dict[str, Page] = {}
    seen: set[int] = set()
    for name, wanted in PAGES.items():
        module = importlib.import_module(name)
        groups: dict[str, list[Entry]] = {}
        for title, entry in _grouped(module, wanted):
            if id(entry.value) not in seen:
                groups.setdefault(title, []).append(entry)
                seen.add(id(entry.value))
        found[name] = Page(name, groups)
    return found


def _grouped(module: ModuleType, wanted: tuple[str, ...] | None) -> Iterator[tuple[str, Entry]]:
    """Yield the names of a module with the titles of their groups, in the order of the import layers."""
    if module.__name__ == "metafem.reference":
        for part in ("single_contacts", "elastic_plastic", "bonded_layer", "height_densities"):
            inner = importlib.import_module(f"metafem.reference.{part}")
            for name, value in vars(inner).items():
                if inspect.isfunction(value) and value.__module__ == inner.__name__ and name[0] != "_":
                    yield inner.__name__, Entry(f"{part}.{name}", value)
        return
    names = module.__all__ if wanted is None else wanted
    entries = [Entry(name, value) for name in names if not inspect.ismodule(value := getattr(module, name))]
    if module.__name__ != "metafem":
        yield from (("", entry) for entry in entries)
        return
    layers = ("material", "caps", "surface", "contact", "substrate", "models", "prediction", "inversion")
    for layer in (*layers, "files", "errors", "notes"):
        inner = importlib.import_module(f"metafem.{layer}")
        for entry in entries:
            if entry.value.__module__.split(".")[1] == layer:
                yield _first(inner.__doc__), entry


def _first(docstring: str | None) -> str:
    """Return the first line of a docstring without its full stop."""
    return (docstring or "").partition("\n")[0].removesuffix(".")


@cache
def public_types() -> frozenset[str]:
    """Return the names of all classes that have a place on a page."""
    return frozenset(
        entry.name for page in pages().values() for entry in page.entries if inspect.isclass(entry.value)
    )


@cache
def addresses() -> dict[str, str]:
    """Return page and anchor of every public name, in the forms in which texts mention it."""
    found: dict[str, str] = {}
    for page in pages().values():
        file, short = f"{page.name}.html", page.name.replace("metafem", "mf")
        found |= {page.name: file, short: file}
        for entry in page.entries:
            inner = members(entry.value) if inspect.isclass(entry.value) else []
            for anchor in (entry.name, *(f"{entry.name}.{member.name}" for member in inner)):
                for form in (f"{page.name}.{anchor}", f"{short}.{anchor}", anchor):
                    found.setdefault(form, f"{file}#{anchor}")
    return found


@cache
def value_names() -> frozenset[str]:
    """Return the names of all parameters and members: in a text such a word is rarely a function."""
    found: set[str] = set()
    for page in pages().values():
        for entry in page.entries:
            functions = [entry.value] if entry.kind in ("class", "function") else []
            if inspect.isclass(entry.value):
                inner = [member for member, _ in _members(entry.value)]
                found |= {member.name for member in inner}
                functions += [member.function for member in inner if member.kind != "property"]
            for function in functions:
                found |= set(inspect.signature(function).parameters)
    return frozenset(found)


def members(cls: type) -> list[Member]:
    """Return the methods and properties of a class that are explained with it."""
    return [member for member, base in _members(cls) if base is None]


def inherited(cls: type) -> dict[str, list[str]]:
    """Return the names of members that another public class explains, by the name of that class."""
    found: dict[str, list[str]] = defaultdict(list)
    for member, base in _members(cls):
        if base is not None:
            found[base].append(member.name)
    return dict(found)


def _members(cls: type) -> Iterator[tuple[Member, str | None]]:
    """Yield public members in the order of their definition, and the public base class that has them."""
    if issubclass(cls, (Enum, BaseException)):
        return
    seen: set[str] = set()
    bases = [each for each in cls.__mro__[1:] if each.__name__ in public_types()]
    for owner in cls.__mro__:
        if not owner.__module__.startswith("metafem"):
            continue
        for name, value in vars(owner).items():
            function, kind = _function(value)
            if name.startswith("_") or name in seen or function is None:
                continue
            seen.add(name)
            docs = map(inspect.getdoc, (function, *(getattr(base, name, None) for base in bases)))
            text = next(filter(None, docs), "")
            if text and _takes_public_types(function):
                member = Member(name, kind, function, text)
                base = next((each.__name__ for each in bases if name in vars(each)), None)
                yield member, None if owner is cls and member.is_long else base


def _function(value: Any) -> tuple[Callable[..., Any] | None, str]:
    """Return the function behind an attribute of a class, and its kind."""
    if isinstance(value, (classmethod, staticmethod)):
        return value.__func__, "constructor" if isinstance(value, classmethod) else "method"
    if isinstance(value, property):
        return value.fget, "property"
    if isinstance(value, cached_property):
        return value.func, "property"
    return (value, "method") if inspect.isfunction(value) else (None, "")


def _takes_public_types(function: Callable[..., Any]) -> bool:
    """Whether no parameter has the type of an internal class: others are for metafem's own use."""
    words = {
        word
        for each in inspect.signature(function).parameters.values()
        for word in re.findall(r"\b[A-Z]\w*", re.sub(r"Literal\[.*?\]", "", str(each.annotation)))
        if each.annotation is not each.empty
    }
    return words <= KNOWN_TYPES | public_types()
