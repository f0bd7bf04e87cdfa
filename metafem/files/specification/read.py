"""Reading of specification files, which are TOML with units in the values, into the package's own types."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from metafem._given import printable, shown
from metafem.caps import SPHERE
from metafem.errors import InvalidInput, refuse_if
from metafem.files.disk import RECORD, RESERVED, SPECIFICATION, TABLE, decoded, file_label, read_bytes
from metafem.files.laws import COLUMNS, columns_of
from metafem.files.part import PartOptions, planned
from metafem.files.specification.fields import Section
from metafem.files.specification.forms import as_toml, bound_words, section_forms
from metafem.files.specification.models import model_named, suggestion
from metafem.files.specification.sections import Sections
from metafem.files.tables import table_of
from metafem.files.units import as_written
from metafem.inversion import Design, Limits, PowerRange, RadiusRange, Target, Tool, arrange, design
from metafem.inversion.limits import pinned_heights
from metafem.inversion.problem import drafting
from metafem.inversion.tools import Tools, default_contact, refuse_misfits
from metafem.models import Model
from metafem.substrate import Substrate
from metafem.surface import PeriodicCell, Surface

__all__ = ["Specification", "parsed", "read_spec", "toml_table"]

# Default of the tables that the text of a specification names: none.
NO_TABLES: Mapping[str, bytes] = {}

# Hint on the most common mistakes in TOML.
REMEDY = 'a value with a unit stands in quotes, such as "1.5 mm", and decimals have a point'

# A dotted key with at least 33 parts. The parser's time grows with the square of the number of parts, and a
# specification needs only two.
NESTED = re.compile(r"""(?:(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){32}""")

# Separators in the path of a file on any operating system, and the longest name of a table [bytes].
SEPARATORS, LONGEST = re.compile(r"[/\\:]"), 240

# Largest number of sites, whose record can be read: that of a site has 250 bytes.
SITES = RECORD // 250

# Where the tables that a specification names are: their contents by name, or a folder.
Source = Mapping[str, bytes] | Path


@dataclass(frozen=True, eq=False)
class Specification:
    """The content of a specification file.

    Attributes
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw or Band
    template : Surface
        The lattice; every site has the largest allowed height.
    limits : Limits
    model : Model
    seed : int
        Seed of the random assignment of heights to sites.
    tilt : float or None
        Tilt of the plane [rad], whose effect is reduced by exchanges of heights between sites.
    tools : RadiusRange, PowerRange, tuple of Tool or of float, or None
        Tools to choose from, or radii of tools [mm]; they replace the radius of the template.
    pinned : mapping of int to float or None
        Prescribed height above the base plane [mm] of some sites; None for a site that stays empty.
    part : PartOptions
        Alignment asperities, chord error and file formats of the part.
    hardness : float or None
        H [MPa], for the plasticity index.
    text : str
        The file's text.
    files : mapping of str to bytes
        Files to store in the result folder: ``spec.toml`` and the tables that it names.
    """

    target: Target
    template: Surface
    limits: Limits
    model: Model
    seed: int
    tilt: float | None
    tools: RadiusRange | PowerRange | tuple[Tool | float, ...] | None
    pinned: Mapping[int, float | None]
    part: PartOptions
    hardness: float | None
    text: str
    files: Mapping[str, bytes] = field(default_factory=dict)

    def design(self, model: Model | None = None, *, draft: bool = False) -> Design:
        """Return the design for the target of the file; the default model is also that of the file.

        A draft ignores the tilt and omits most of the search.
        """
        chosen = self.model if model is None else model
        remedy = "add [block] with width, length and thickness"
        refuse_missing_block(chosen, self.template, remedy)
        limits = replace(self.limits, pinned=self.pinned)
        with drafting() if draft else nullcontext():
            found = design(self.target, self.template, chosen, limits, self.seed, tools=self.tools)
        return found if draft or self.tilt is None else arrange(found, self.tilt, self.seed)


def refuse_missing_block(model: Model, surface: Surface, remedy: str) -> None:
    """Raise InvalidInput if a model needs a block and the surface has none; the error states `remedy`."""
    substrate = getattr(model, "substrate", None)
    if surface.block is not None or not isinstance(substrate, Substrate):
        return
    try:
        substrate.for_surface(surface)
    except InvalidInput:
        raise InvalidInput(f"the model {model.name} needs the block's dimensions: {remedy}") from None


def read_spec(path: str | Path) -> Specification:
    """Read a specification file.

    Parameters
    ----------
    path : str or Path
        A TOML file with the sections target, material, lattice and limits, and the optional sections
        friction, sites, tools, block, cell, layout, model, cap, contact, part and checks;
        ``metafem spec`` lists their keys. Lengths, areas, forces, stresses and angles are strings with a
        unit, such as ``"120 um"``.

    Returns
    -------
    Specification

    Raises
    ------
    InvalidInput
        If the file cannot be read, if a section or key is unknown or missing, or if a value has the wrong
        type, unit or range. The error has one line for each problem.

    Examples
    --------
    >>> import tempfile
    >>> from metafem.files.specification.models import demo_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "linear.toml")
    ...     _ = path.write_text(demo_text("linear"), encoding="utf-8")
    ...     spec = read_spec(path)
    >>> spec.target, spec.limits.max_height
    (LinearLaw(slope=6.87, load_range=None), 0.12)
    """
    raw = read_bytes(path, SPECIFICATION, "no such file; `metafem demo linear` writes one to start from")
    name, text = file_label(path), raw.decode("utf-8", "surrogateescape")
    return of_table(toml_table(text, name), text, Path(path).parent, name)


def parsed(text: str, tables: Mapping[str, bytes] = NO_TABLES, name: str = "spec.toml") -> Specification:
    """Return the specification in a text, which is read as `read_spec` reads a file.

    Parameters
    ----------
    text : str
        The text of a specification file.
    tables : mapping of str to bytes, optional
        Content of the tables, by their names in the text; default: none.
    name : str, optional
        Name of the specification in errors.

    Returns
    -------
    Specification

    Raises
    ------
    InvalidInput
        In the same cases as `read_spec`; each of its `problems` names the key.

    Examples
    --------
    >>> from metafem.files.specification.models import demo_text
    >>> parsed(demo_text("linear")).target
    LinearLaw(slope=6.87, load_range=None)
    >>> try:
    ...     parsed(demo_text("linear").replace('"1.5 mm"', "1.5"))
    ... except InvalidInput as error:
    ...     print(*error.problems)
    lattice.pitch = 1.5 needs a unit; write for example "1.5 mm"
    """
    return of_table(toml_table(text, file_label(name)), text, tables, file_label(name))


def of_table(
    table: Mapping[str, Any], text: str = "", source: Source = NO_TABLES, name: str = "spec.toml"
) -> Specification:
    """Return the specification in a table that has this text, as `parsed` returns that in a text."""
    table = {key: {**value} if isinstance(value, dict) else value for key, value in table.items()}
    table.pop("covariance", None)  # that of a calibration, which studies read
    try:
        kept = fill(table, source)
        members = _members(Sections.model_validate(table))
    except ValidationError as error:
        raise _refused(name, *(problem(each, table) for each in error.errors(include_url=False))) from None
    except InvalidInput as error:
        raise _refused(name, _as_given(error, table)) from None
    raw = text.encode("utf-8", "surrogatepass")
    return Specification(**members, text=text, files={"spec.toml": raw, **kept})


def toml_table(text: str, name: str = "spec.toml") -> dict[str, Any]:
    """Return the sections in the text of a specification, as tomllib reads them.

    Examples
    --------
    >>> toml_table("[layout]\\nseed = 3")
    {'layout': {'seed': 3}}
    """
    raw = text.encode("utf-8", "surrogatepass")
    most = f"{SPECIFICATION / 2**20:g} MiB, the limit for its kind of file"
    refuse_if(len(raw) > SPECIFICATION, f"{name}: is larger than {most}")
    text = decoded(name, raw)
    deep = "nests its values too deeply to be a specification"
    if NESTED.search(text):
        raise _refused(name, deep)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise _refused(name, deep) from None
    except ValueError as error:  # a number with thousands of digits is a ValueError too
        end = f"at line {len(text.splitlines())}, the end of the file"
        cause = printable(str(error).replace("at end of document", end))
        raise _refused(name, f"not valid TOML: {cause}; {REMEDY}") from None


def fill(table: dict[str, Any], source: Source) -> dict[str, bytes]:
    """Replace each key `file` in `table` by the columns of the table that it names.

    Return the contents of these tables by the last part of their names. A result folder keeps them under
    these names beside its copy of the specification, where they are found again.
    """
    kept: dict[str, bytes] = {}
    for place, section in table.items():
        kind = section.get("kind") if isinstance(section, dict) else None
        if kind not in [*COLUMNS] or "file" not in section:
            continue
        name, key = section.pop("file"), f"{place}.file"
        given = as_written(name)
        last = SEPARATORS.split(name)[-1] if isinstance(name, str) else ""
        wrong = not last.strip(" .") or not name.isprintable() or len(last.encode()) > LONGEST
        words = f"must end with the printable name of a file, of at most {LONGEST} bytes"
        refuse_if(wrong, words, value=given, example='file = "wanted.csv"', key=key)
        taken = last.casefold() in {each.casefold() for each in (*RESERVED, *kept)}
        refuse_if(taken, "has the name of another file of a result; rename the table", value=given, key=key)
        try:
            kept[last] = _content(name, last, source)
            columns = columns_of(table_of(file_label(name), kept[last]), kind)
        except InvalidInput as error:
            raise InvalidInput(f"cannot be used: {error}", key=key) from None
        twice = sorted(section.keys() & columns.keys())
        refuse_if(twice, f"and {', '.join(twice)} both give the points; keep one", key=key)
        section |= {key: list(column) for key, column in columns.items()}
    return kept


def _content(name: str, last: str, source: Source) -> bytes:
    """Return the content of a table, which is where its name says, or beside the specification."""
    if isinstance(source, Path):
        beside = not (source / name).exists() and (source / last).exists()
        return read_bytes(source / (last if beside else name), TABLE)
    known = ", ".join(printable(other, 60) for other in source) or "none"
    refuse_if(not {name, last} & source.keys(), f"{shown(name)} is not loaded (loaded: {known})")
    found = source[name] if name in source else source[last]
    refuse_if(len(found) > TABLE, f"{shown(name)} is larger than {TABLE / 2**20:g} MiB")
    return found


def _members(given: Sections) -> dict[str, Any]:
    """Return the members of a `Specification`; raise InvalidInput for the first problem between sections."""
    material, limits, part = given.material.value(), given.limits.value(), given.part.value()
    parts: Any = (given.friction, given.block, given.tools, given.cap)
    friction, block, tools, cap = (None if each is None else each.value() for each in parts)
    contact = given.contact.value()
    if "contact" not in given.model_fields_set and cap is None:
        contact = default_contact(tools)
    with _within("target"):
        target = given.target.target(material, friction)
    with _within("model"):
        model = model_named(given.model.kind, contact, block)
    with _within("lattice"):
        radii = _radii(given)
        (rows, columns), pitch = given.lattice.shape, given.lattice.pitch
        words = f"has {rows * columns:,} sites; at most {SITES:,} are allowed, so that the result can be read"
        refuse_if(rows * columns > SITES, words, key="shape", value=f"[{rows}, {columns}]")
        sides = None if given.cell is None else (given.cell.width, given.cell.length)
        template = Surface.square_lattice(
            limits.top,
            (rows, columns),
            pitch,
            radius=min(radii),
            material=material,
            friction=friction,
            block=block,
            cap=cap or SPHERE,
            cell=sides and PeriodicCell(sides[0] or columns * pitch, sides[1] or rows * pitch),
        )
    for key in ("empty", "pinned"):
        last = max(getattr(given.sites, key), default=0)
        words = f"holds {last}; the lattice has the sites 1 to {template.count}"
        refuse_if(last > template.count, words, key=f"sites.{key}")
    try:
        pinned = pinned_heights(template, replace(limits, pinned=given.sites.value()))
    except InvalidInput as error:
        site = error.key.removeprefix("pinned[").rstrip("]")
        if site.isdecimal():
            raise error.at(f"sites.heights[{given.sites.pinned.index(int(site) + 1)}]") from None
        raise InvalidInput(f"do not suit: {error}", key="sites") from None
    words = (
        f"and limits.offset = {limits.offset:g} mm together exceed the largest radius, {max(radii):g} mm: a "
        "cap cannot be higher than its radius; lower them, or omit [block] and with it the part files"
    )
    high = block is not None and template.cap == SPHERE and limits.top > max(radii)
    refuse_if(high, words, key="limits.max_height", value=limits.max_height)
    if tools is None:
        planned(template, template, part)
    else:
        try:
            refuse_misfits(Tools.of(tools, template, contact), template, limits.top)
        except InvalidInput as error:
            raise InvalidInput(f"do not suit: {error}", key="tools") from None
    return {
        "target": target,
        "template": template,
        "limits": limits,
        "model": model,
        "seed": given.layout.seed,
        "tilt": given.layout.tilt,
        "tools": tools,
        "pinned": pinned,
        "part": part,
        "hardness": given.checks.hardness,
    }


def _radii(given: Sections) -> Sequence[float]:
    """Return the radii of the tools, their bounds, or the radius of the lattice [mm]."""
    one, tools = given.lattice.radius, given.tools
    if tools is None or tools.exponent_range is not None:
        missing = "is missing" + ("" if tools else ", and there is no section [tools]")
        refuse_if(one is None, missing, key="radius", example='radius = "526 um"')
        return [one or 0.0]
    refuse_if(one is not None, "and [tools] both give radii; keep one", key="radius")
    return tools.radii or tools.radius_range or ()


@contextmanager
def _within(section: str) -> Iterator[None]:
    """Make errors of the body concern keys of a section; the sides of a cell follow from the lattice."""
    try:
        yield
    except InvalidInput as error:
        raise error.within(
            "cell" if error.key.partition("[")[0] in ("width", "length") else section
        ) from None


def problem(detail: Any, table: Mapping[str, Any], sections: type[Section] = Sections) -> InvalidInput:
    """Return the problem that an error of pydantic describes, with its key, value and an example."""
    keys, kind, value = _place(detail["loc"], table)
    name, path = keys[-1], "".join(f"[{each}]" if isinstance(each, int) else f".{each}" for each in keys)[1:]
    form = section_forms(sections).get(".".join(each for each in keys[:-1] if isinstance(each, str)), {})
    of_kinds = form.get("keys", {})
    known = {key["name"]: key for key in of_kinds.get(kind, of_kinds.get("", ()))}
    own = known.get(name, {})
    example = f"{name} = {as_toml(own['example'])}" if own else ""
    match detail["type"]:
        case "value_error":
            error: InvalidInput = detail["ctx"]["error"]
            if error.key:
                return _as_given(error.within(path), table)
            if error.example and isinstance(own.get("example"), str):
                error.example = as_toml(own["example"])
            return error.at(path)
        case "missing":
            words = "is missing" if own else f"is missing; write a section [{path}]"
            return InvalidInput(words, key=path, example=example)
        case "extra_forbidden":
            names = (*known, *["kind"] * bool(form.get("kinds"))) or (*Sections.model_fields,)
            what = "key" if len(keys) > 1 else "section"
            return InvalidInput(f"is an unknown {what}{suggestion(str(name), names)}", key=printable(path))
        case "union_tag_not_found" | "union_tag_invalid":
            kinds = tuple(section_forms(sections)[path]["kinds"])
            given = value.get("kind") if isinstance(value, dict) else None
            words = "is missing" if given is None else f"is unknown{suggestion(str(given), kinds)}"
            value = None if given is None else as_written(given)
            return InvalidInput(words, key=f"{path}.kind", value=value, example=f'kind = "{kinds[0]}"')
        case "literal_error":
            words = f"is unknown{suggestion(str(value), tuple(own['names']))}"
            return InvalidInput(words, key=path, value=as_written(value))
        case "model_type" | "model_attributes_type" | "dict_type":
            example, must = "", f"must be a section: write [{path}] on a line of its own"
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal":
            ((bound, number),) = detail["ctx"].items()
            must = f"must be {bound_words(bound, number, own.get('unit', ''))}"
        case _:
            must = re.sub(r"^\w+ should", "must", detail["msg"])
    return InvalidInput(must, key=path, value=as_written(value), example=example)


def _place(place: Iterable[Any], table: Any) -> tuple[list[Any], str, Any]:
    """Return the keys of pydantic's place of an error, without kinds; the last section's kind; the value."""
    keys: list[Any] = []
    kind = ""
    for part in place:
        if isinstance(table, dict):
            if part == table.get("kind") and part not in table:  # pydantic adds the kind
                kind = part
                continue
            kind = str(table.get("kind", "")) if keys else ""
            table = table.get(part)
        else:
            table = table[part] if isinstance(table, list) and part < len(table) else None
        keys.append(part)
    return keys, kind, table


def _as_given(error: InvalidInput, table: Mapping[str, Any]) -> InvalidInput:
    """Return a problem with the value as the specification states it."""
    parts = re.findall(r"[^.\[\]]+", error.key)
    *_, value = _place([int(part) if part.isdecimal() else part for part in parts], table)
    if error.value is not None and value is not None:
        error.value = as_written(value)
    return error


def _refused(name: str, *problems: InvalidInput | str) -> InvalidInput:
    found = (InvalidInput(each) if isinstance(each, str) else each for each in problems)
    return InvalidInput(name, problems=tuple(found))
