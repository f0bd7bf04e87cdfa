"""Specification files: TOML with units in the values, read into the package's own types."""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from metafem.errors import InvalidInput
from metafem.files.manual import all_keys, as_toml
from metafem.files.model_names import suggestion
from metafem.files.wanted_table import with_samples
from metafem.inversion import (
    Design,
    Layout,
    Limits,
    RadiusRange,
    Target,
    design,
    design_radii,
    design_radius,
)
from metafem.models import Model
from metafem.substrate import Substrate
from metafem.surface import Surface

if TYPE_CHECKING:
    from pydantic import BaseModel

__all__ = ["Specification", "read_spec"]

# How radii are chosen: one for all asperities, or each its own.
SEARCHES: Mapping[bool, Callable[..., Design]] = {False: design_radius, True: design_radii}


@dataclass(frozen=True, eq=False)
class Specification:
    """What a specification file asks for.

    Attributes
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw or MultilinearLaw
    template : Surface
        The lattice, every site as tall as the limits allow.
    limits : Limits
    model : Model
    seed : int
        Of the deal of heights to sites.
    layout : Layout or None
        What the sites are chosen for.
    radii : RadiusRange, tuple of float or None
        From which the radius is chosen [mm]; that of the template then counts for nothing.
    mixed : bool
        Whether each asperity may have its own radius.
    alignment_height : float or None
        Height of the four alignment asperities [mm].
    hardness : float or None
        H [MPa] for the plasticity index.
    text : str
        The file's text.
    sha256 : str
        Hexadecimal hash of the file's bytes.
    tables : mapping of str to bytes
        Files beside it that it names, kept with its result.
    """

    target: Target
    template: Surface
    limits: Limits
    model: Model
    seed: int
    layout: Layout | None
    radii: RadiusRange | tuple[float, ...] | None
    mixed: bool
    alignment_height: float | None
    hardness: float | None
    text: str
    sha256: str
    tables: Mapping[str, bytes] = field(default_factory=dict)

    def design(self, model: Model | None = None) -> Design:
        """Design what the file asks for, under its model unless another is given."""
        chosen = self.model if model is None else model
        self._refuse_missing_block(chosen)
        if self.radii is None:
            return design(self.target, self.template, chosen, self.limits, self.seed, layout=self.layout)
        search = SEARCHES[self.mixed]
        return search(
            self.target, self.template, self.radii, chosen, self.limits, self.seed, layout=self.layout
        )

    def _refuse_missing_block(self, model: Model) -> None:
        """Say in the words of the file that a model needs a block: the model's own speak of arguments."""
        substrate = getattr(model, "substrate", None)
        if self.template.block is not None or not isinstance(substrate, Substrate):
            return
        try:
            substrate.for_surface(self.template)
        except InvalidInput:
            raise InvalidInput(
                f"the model on {type(substrate).__name__} needs the block's sizes: add [block] with width, "
                "length and thickness"
            ) from None


def read_spec(path: str | Path) -> Specification:
    """Read a specification file.

    Parameters
    ----------
    path : str or Path
        A TOML file with the sections target, material, lattice and limits, and, where wanted,
        friction, radii, block, layout, model, part and checks; ``metafem spec`` lists their keys.
        Lengths, areas, forces, stresses and angles are texts with a unit, as ``"120 um"``.

    Returns
    -------
    Specification

    Raises
    ------
    InvalidInput
        If the file cannot be read, or for unknown or missing sections and keys, and values of the
        wrong kind, unit or range: one line for each problem.

    Examples
    --------
    >>> import tempfile
    >>> from metafem.files.demo import demo_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "linear.toml")
    ...     _ = path.write_text(demo_text("linear"), encoding="utf-8")
    ...     spec = read_spec(path)
    >>> spec.target, spec.limits.max_height
    (LinearLaw(slope=6.87, through_origin=False), 0.12)
    """
    raw = _bytes(Path(path))
    text = _decoded(path, raw)
    table, tables = with_samples(_table(path, text), Path(path).parent)
    from pydantic import ValidationError

    from metafem.files.sections import Sections

    try:
        sections = Sections.model_validate(table)
    except ValidationError as error:
        problems = [_worded(detail, Sections) for detail in error.errors(include_url=False)]
        raise _refused(path, problems) from None
    parts, problems = sections.build()
    mixed = sections.radii is not None and sections.radii.mixed
    if problems:
        raise _refused(path, problems)
    return Specification(
        **parts,
        model=sections.model.model(),
        seed=sections.layout.seed,
        mixed=mixed,
        alignment_height=sections.part.alignment_height,
        hardness=sections.checks.hardness,
        text=text,
        sha256=hashlib.sha256(raw).hexdigest(),
        tables=tables,
    )


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InvalidInput(f"{path}: no such file; `metafem demo linear` writes one to start from") from None
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read: {error.strerror}") from None


def _decoded(path: str | Path, raw: bytes) -> str:
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InvalidInput(f"{path}: line {line} is not UTF-8; save the file with that encoding") from None


def _table(path: str | Path, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError:
        raise InvalidInput(f"{path} nests its values too deeply to be a specification") from None
    except tomllib.TOMLDecodeError as error:
        end = f"at line {len(text.splitlines())}, the end of the file"
        cause = str(error).replace("at end of document", end)
        raise InvalidInput(f"{path}: not valid TOML: {cause}") from None


def _refused(path: str | Path, problems: list[str]) -> InvalidInput:
    return InvalidInput("\n".join(f"{path}: {problem}" for problem in problems))


def _worded(detail: Any, sections: type[BaseModel]) -> str:
    """Return one of pydantic's findings in the package's words."""
    place, kind, given = [str(part) for part in detail["loc"]], detail["type"], detail["input"]
    if place[0] == "target" and len(place) > 1 and kind != "union_tag_not_found":
        del place[1]  # the kind of target, which pydantic counts as a place
    name = next(part for part in reversed(place) if not part.isdigit())
    key = re.sub(r"\.(\d+)", r"[\1]", ".".join(place))
    example = _example(place, name)
    if kind == "extra_forbidden":
        what = "section" if len(place) == 1 else "key"
        return f"{key} is an unknown {what}{suggestion(name, tuple(_known(detail['loc'], sections)))}"
    if kind == "missing":
        return f"section [{key}] is missing" if len(place) == 1 else f"{key} is missing{example}"
    if kind == "union_tag_not_found":
        return 'target.kind is missing; write for example kind = "linear"'
    if kind == "union_tag_invalid":
        tag = str(detail["ctx"]["tag"])
        return f'target.kind = "{tag:.60}" is unknown{suggestion(tag, tuple(_target_kinds(sections)))}'
    if kind == "value_error":
        return f"{key} {detail['ctx']['error']}"
    if kind in ("model_type", "model_attributes_type"):
        return f"{key} = {given!r:.60} must be a section: write [{key}] on a line of its own"
    message = detail["msg"].replace("Input should", "should")
    return f"{key} = {given!r:.60}: {message}{example}"


def _example(place: list[str], name: str) -> str:
    """Return how a key would look, for the end of an error."""
    for key in all_keys():
        if (key.section, key.name) == (place[0], name):
            return f"; write for example {name} = {as_toml(key.example)}"
    return ""


def _known(place: tuple[Any, ...], sections: type[BaseModel]) -> Iterator[str]:
    """Yield the names that are known where an unknown one stands."""
    if len(place) == 1:
        yield from sections.model_fields
        return
    annotation = sections.model_fields[place[0]].annotation
    for kind in get_args(annotation) or (annotation,):
        fields = getattr(kind, "model_fields", {})
        if place[0] != "target" or place[1] in get_args(fields["kind"].annotation):
            yield from fields


def _target_kinds(sections: type[BaseModel]) -> Iterator[str]:
    for kind in get_args(sections.model_fields["target"].annotation):
        yield from get_args(kind.model_fields["kind"].annotation)
