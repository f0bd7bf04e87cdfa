"""Reading of specification files, which are TOML with units in the values, into the package's own types."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from metafem._given import AS_IN_PYTHON, Names, printable
from metafem.errors import InvalidInput
from metafem.files.part.plan import PartOptions, planned
from metafem.files.reading import SPECIFICATION, decoded, file_label, read_bytes
from metafem.files.specification.contents import Sections, tell_cost
from metafem.files.specification.named_tables import Source, among, in_folder, with_tables
from metafem.files.specification.problems import problem
from metafem.files.units import written_units
from metafem.inversion import (
    Design,
    Limits,
    PowerRange,
    RadiusRange,
    Target,
    Tool,
    arrange,
    design,
)
from metafem.inversion.problem import drafting
from metafem.models import Model
from metafem.substrate import Substrate
from metafem.surface import Surface

__all__ = ["Specification", "parsed", "read_spec", "toml_table"]

# Default of the tables that the text of a specification names: none.
NO_TABLES: Mapping[str, bytes] = {}

# Hint on the most common mistakes in TOML.
REMEDY = 'a value with a unit stands in quotes, such as "1.5 mm", and decimals have a point'

# A dotted key with at least 33 parts. The parser's time grows with the square of the number of parts, and a
# specification needs only two.
NESTED = re.compile(r"""(?:(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){32}""")


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
        tell_cost(self.template.count)
        limits = replace(self.limits, pinned=self.pinned)
        with drafting() if draft else nullcontext():
            found = design(self.target, self.template, chosen, limits, self.seed, tools=self.tools)
        return found if draft or self.tilt is None else arrange(found, self.tilt, self.seed)

    def with_chord_error(self, chord_error: float) -> Specification:
        """Return the specification with another chord error of the part [mm].

        Raises
        ------
        InvalidInput
            If the chord error is not positive, or so small that the files of the part would be too large.
        """
        part = replace(self.part, chord_error=chord_error)
        planned(self.template, self.template, part)
        return replace(self, part=part)


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
    decoded(path, raw)  # raises an error with the line if the file is not UTF-8
    return _specification(file_label(path), raw, in_folder(Path(path).parent))


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
    try:
        raw = text.encode("utf-8")
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise _refused(name, f"line {line} has a character that UTF-8 does not know") from None
    if len(raw) > SPECIFICATION:
        raise _refused(name, f"is larger than {SPECIFICATION / 2**20:g} MiB, the limit for its kind of file")
    return _specification(file_label(name), raw, among(tables))


def _specification(name: str, raw: bytes, source: Source) -> Specification:
    """Return the specification in the UTF-8 text `raw`; errors call it `name`, `source` reads its tables."""
    text = raw.decode("utf-8")
    table = toml_table(text, name)
    try:
        kept = with_tables(text, table, source)
    except InvalidInput as error:
        raise _refused(name, error) from None
    names = Names(units=written_units(table))
    try:
        sections = Sections.model_validate(table)
    except ValidationError as error:
        problems = [problem(detail) for detail in error.errors(include_url=False)]
        raise _refused(name, *problems, names=names) from None
    parts, problems = sections.build()
    if problems:
        raise _refused(name, *problems, names=names)
    return Specification(
        **parts,
        seed=sections.layout.seed,
        tilt=sections.layout.tilt,
        hardness=sections.checks.hardness,
        text=text,
        files=kept,
    )


def toml_table(text: str, name: str = "spec.toml") -> dict[str, Any]:
    """Return the sections in the text of a specification, as tomllib reads them.

    Examples
    --------
    >>> toml_table("[layout]\\nseed = 3")
    {'layout': {'seed': 3}}
    """
    text = text.removeprefix("\ufeff")
    deep = "nests its values too deeply to be a specification"
    if NESTED.search(text):
        raise _refused(name, deep)
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise _refused(name, deep) from None
    except ValueError as error:  # a number with thousands of digits is a ValueError too
        end = f"at line {len(text.splitlines())}, the end of the file"
        cause = printable(str(error).replace("at end of document", end))
        raise _refused(name, f"not valid TOML: {cause}; {REMEDY}") from None
    return table


def _refused(name: str, *problems: InvalidInput | str, names: Names = AS_IN_PYTHON) -> InvalidInput:
    found = tuple(InvalidInput(each) if isinstance(each, str) else each for each in problems)
    for each in found:
        each.names = names
    return InvalidInput(name, problems=found)
