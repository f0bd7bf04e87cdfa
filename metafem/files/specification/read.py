"""Reading of specification files, which are TOML with units in the values, into the package's own types."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

import metafem as mf
from metafem.contact import Contact
from metafem.errors import InvalidInput, printable, refuse_if, shown
from metafem.files.disk import RESERVED, SPECIFICATION, TABLE, file_label, read_bytes
from metafem.files.laws import Keys, columns_of
from metafem.files.part import planned
from metafem.files.specification import model_named
from metafem.files.specification.forms import Sections, as_given, problem, section_forms
from metafem.files.specification.sections import PartSection
from metafem.files.tables import table_of
from metafem.files.units import as_written
from metafem.inversion import Target
from metafem.inversion.limits import pinned_heights
from metafem.inversion.problem import drafting
from metafem.models import Model
from metafem.models.model import contact_of, with_contact
from metafem.substrate import Substrate

# Default of the tables that the text of a specification names: none.
NO_TABLES: Mapping[str, bytes] = {}

# Hint on the most common mistakes in TOML.
REMEDY = 'a value with a unit stands in quotes, such as "1.5 mm", and decimals have a point'

# Separators in the path of a file on any operating system.
SEPARATORS = re.compile(r"[/\\:]")

# Where the tables that a specification names are: their contents by name, or a folder.
Source = Mapping[str, bytes] | Path


@dataclass(frozen=True, eq=False)
class Specification:
    """The content of a specification file.

    The target, the template and the model are made when they are first asked for.

    Attributes
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw or Band
    template : Surface
        The lattice; every site has the largest allowed height.
    limits : Limits
    model : Model
    tools : RadiusRange, tuple of float, or None
        Radii of tools to choose from [mm]; they replace the radius of the template.
    part : PartSection
        Alignment asperities, chord error and drilling program of the part.
    hardness : float or None
        H [MPa], for the plasticity index.
    text : str
        The file's text.
    files : mapping of str to bytes
        Files to store in the result folder: ``spec.toml`` and the tables that it names.
    """

    sections: Any
    table: Mapping[str, Any]  # the sections as they are written
    name: str
    limits: mf.Limits
    tools: mf.RadiusRange | tuple[float, ...] | None
    part: PartSection
    hardness: float | None
    text: str
    files: Mapping[str, bytes]

    @cached_property
    def target(self) -> Target:
        """The target law."""
        given = self.sections
        with self._within("target"):
            found: Target = given.target.target(given.material, given.friction)
            return found

    @cached_property
    def model(self) -> Model:
        """The model under which the target is to be met."""
        given = self.sections
        return model_named(given.model.kind, given.contact, given.block)

    @cached_property
    def template(self) -> mf.Surface:
        """The lattice; every site has the largest allowed height."""
        given, tools = self.sections, self.tools
        (rows, columns), pitch, radius = given.lattice.shape, given.lattice.pitch, given.lattice.radius
        words = "or a section [tools] must give the radii, not both"
        with self._within("lattice"):
            refuse_if((radius is None) == (tools is None), words, key="radius", example='radius = "526 um"')
            lattice = mf.Surface.square_lattice(
                self.limits.top,
                (rows, columns),
                pitch,
                radius=radius or (tools.low if isinstance(tools, mf.RadiusRange) else min(tools or ())),
                material=given.material,
                friction=given.friction,
                block=given.block,
                cap=given.cap or mf.Sphere(),
            )
        if given.cell is None:
            return lattice
        with self._within("cell"):
            sides = given.cell.width or columns * pitch, given.cell.length or rows * pitch
            return lattice.replaced(cell=mf.PeriodicCell(*sides))

    @contextmanager
    def _within(self, section: str = "") -> Iterator[None]:
        """Make errors of the body those of this specification, and of keys of a section if one is given."""
        try:
            yield
        except InvalidInput as error:
            found = as_given(error.within(section) if section else error, self.table)
            raise InvalidInput(self.name, problems=(found,)) from None

    def check(self) -> None:
        """Raise InvalidInput if the sections do not suit each other, such as heights and radii."""
        template, sites = self.template, self.sections.sites
        _ = self.target, self.model
        pinned = [site for site, height in sites.items() if height is not None]
        with self._within():
            for site, height in sites.items():
                words = f"holds {site + 1}; the lattice has the sites 1 to {template.count}"
                refuse_if(
                    site >= template.count, words, key=f"sites.{'empty' if height is None else 'pinned'}"
                )
            try:
                pinned_heights(template, self.limits)
            except InvalidInput as error:
                name = error.key.removeprefix("pinned[").rstrip("]")
                if name.isdecimal():
                    raise error.at(f"sites.heights[{pinned.index(int(name))}]") from None
                raise InvalidInput(f"do not suit: {error}", key="sites") from None
            if self.tools is None:
                planned(template, template, self.part)

    def design(
        self, model: Model | None = None, target: Target | None = None, *, draft: bool = False
    ) -> mf.Design:
        """Return the design; default: for the target and under the model of the file.

        A draft ignores the tilt and omits most of the search.
        """
        self.check()
        chosen, layout = self.model if model is None else model, self.sections.layout
        refuse_missing_block(chosen, self.template)
        with drafting() if draft else nullcontext():
            goal = self.target if target is None else target
            found = mf.design(goal, self.template, chosen, self.limits, layout.seed, tools=self.tools)
        return found if draft or layout.tilt is None else mf.arrange(found, layout.tilt, layout.seed)


def refuse_missing_block(model: Model, surface: mf.Surface) -> None:
    """Raise InvalidInput if a model needs a block and the surface has none."""
    substrate = getattr(model, "substrate", None)
    try:
        if surface.block is None and isinstance(substrate, Substrate):
            substrate.for_surface(surface)
    except InvalidInput:
        needs = "needs the block: give its width, length and thickness, in a section [block] or by options"
        raise InvalidInput(f"the model {model.name} {needs}") from None


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
        type, unit or range. The error has one line for each problem. Whether the sections suit each other
        is checked by `Specification.check`, with which `Specification.design` begins.

    Examples
    --------
    >>> import tempfile
    >>> from metafem.files import demo_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "linear.toml")
    ...     _ = path.write_text(demo_text("linear"), encoding="utf-8")
    ...     spec = read_spec(path)
    >>> spec.target, spec.limits.max_height
    (LinearLaw(slope=6.87, load_range=None), 0.12)
    """
    raw = read_bytes(path, SPECIFICATION, "no such file; `metafem demo linear` writes one to start from")
    name, text = file_label(path), raw.decode("utf-8", "surrogateescape")
    return _of_sections(toml_table(text, name), text, Path(path).parent, name)


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
        In the same cases as `read_spec`, and if the sections do not suit each other; each of the
        `problems` of the error names the key.

    Examples
    --------
    >>> from metafem.files import demo_text
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
    found = _of_sections(table, text, source, name)
    found.check()
    return found


def _of_sections(table: Mapping[str, Any], text: str, source: Source, name: str) -> Specification:
    """Return the specification in a table of sections; that they suit each other is not checked."""
    kept: dict[str, bytes] = {}
    table = {key: section for key, section in table.items() if key != "covariance"}  # which studies read
    try:
        given: Any = Sections.model_validate(table, context=_reader(source, kept))
    except ValidationError as error:
        problems = tuple(problem(each, table) for each in error.errors(include_url=False))
        raise InvalidInput(name, problems=problems) from None
    limits = replace(given.limits, pinned=given.sites)
    files = {"spec.toml": text.encode("utf-8", "surrogatepass"), **kept}
    options = limits, given.tools, given.part, given.checks.hardness
    return Specification(given, table, name, *options, text, files)


def toml_table(text: str, name: str = "spec.toml") -> dict[str, Any]:
    """Return the sections in the text of a specification, as tomllib reads them.

    Examples
    --------
    >>> toml_table("[layout]\\nseed = 3")
    {'layout': {'seed': 3}}
    """
    most = f"{SPECIFICATION / 2**20:g} MiB, the limit for its kind of file"
    refuse_if(len(text) > SPECIFICATION, f"{name}: is larger than {most}")
    try:
        text.encode()
        return tomllib.loads(text.removeprefix("\ufeff"))
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise InvalidInput(f"{name}: line {line} is not UTF-8; save the file with that encoding") from None
    except (RecursionError, ValueError) as error:  # of deep nesting, or a number with thousands of digits
        end = f"at line {len(text.splitlines())}, the end of the file"
        cause = printable(str(error).replace("at end of document", end))
        found = InvalidInput(f"not valid TOML: {cause}; {REMEDY}")
        raise InvalidInput(name, problems=(found,)) from None


def _reader(source: Source, kept: dict[str, bytes]) -> Callable[[str, str], Keys]:
    """Return the function that returns the columns of the table with a name, for a section of a kind.

    The contents of the tables are kept by the last part of their names. A result folder keeps them under
    these names beside its copy of the specification, where they are found again.
    """

    def columns(name: str, kind: str) -> Keys:
        last, given = SEPARATORS.split(name)[-1], as_written(name)
        wrong = not last.strip(" .") or not last.isprintable()
        refuse_if(wrong, "must end with the printable name of a file", value=given, key="file")
        taken = last.casefold() in {each.casefold() for each in (*RESERVED, *kept)}
        words = "has the name of another file of a result; rename the table"
        refuse_if(taken, words, value=given, key="file")
        try:
            kept[last] = _content(name, last, source)
            return columns_of(table_of(file_label(name), kept[last]), kind)
        except InvalidInput as error:
            raise InvalidInput(f"cannot be used: {error}", key="file") from None

    return columns


def _content(name: str, last: str, source: Source) -> bytes:
    """Return the content of a table, which is where its name says, or beside the specification."""
    if isinstance(source, Path):
        beside = not (source / name).exists() and (source / last).exists()
        return read_bytes(source / (last if beside else name), TABLE)
    known = ", ".join(printable(other, 60) for other in source) or "none"
    refuse_if(not {name, last} & source.keys(), f"{shown(name)} is not loaded (loaded: {known})")
    return source[name] if name in source else source[last]


def chosen_model(model: Model, name: str | None, contact: str | None, surface: mf.Surface) -> Model:
    """Return the model that ``--model`` and ``--contact`` state; defaults: `model` and its contact law."""
    law = contact_of(model) if contact is None else contact_named(contact)
    found = with_contact(model, law) if name is None else model_named(name, law, surface.block)
    refuse_missing_block(found, surface)
    return found


def contact_named(text: str) -> Contact:
    """Return the contact law of ``--contact``: its kind, and the value of its first key.

    Examples
    --------
    >>> contact_named("jkr 9 mJ/m^2")
    JKR(adhesion_energy=9e-06, cap=Hertz())
    """
    kind, _, value = text.strip().partition(" ")
    keys = section_forms()["contact"]["keys"].get(kind, ())
    name = next((key["name"] for key in keys if not key["listed"]), value)
    given = {"kind": kind, **({name: value} if value else {})}
    contact: Contact = section_value("contact", given)
    return contact


def section_value(name: str, given: Mapping[str, Any]) -> Any:
    """Return the value of a section whose keys are given without a specification."""
    field = Sections.model_fields[name]
    kind: Any = Annotated[field.annotation, Field(discriminator=field.discriminator)]
    try:
        return TypeAdapter(kind).validate_python(given, context=_reader(Path(), {}))
    except ValidationError as error:
        detail = error.errors(include_url=False)[0]
    raise problem({**detail, "loc": (name, *detail["loc"])}, {name: given})
