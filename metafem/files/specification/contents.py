"""All sections of a specification, and the values that are built from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from metafem._given import Given as Quantity
from metafem.caps import SPHERE, Cap
from metafem.contact import Contact
from metafem.errors import InvalidInput, refuse_if
from metafem.files.part.caps import CannotBeMade
from metafem.files.part.plan import PartOptions, planned
from metafem.files.reading import RECORD
from metafem.files.specification import sections
from metafem.files.specification.contacts import ContactSection, HertzSection, ShapeSection
from metafem.files.specification.fields import Section, key, optional
from metafem.files.specification.models import model_named
from metafem.files.specification.targets import AnyTarget
from metafem.inversion import Limits
from metafem.inversion.tools import Given, Tools, default_contact, refuse_misfits
from metafem.models._resources import require_memory
from metafem.progress import message
from metafem.surface import Block, Friction, Material, PeriodicCell, Surface

# Cost of one site: size of its record [bytes], peak memory [bytes], and time for the design, the report and
# the files [s]. They were measured under the independent model on lattices of 10^5 and 10^6 sites.
RECORDED, MEMORY, TIME = 250, 1_800, 4.5e-5

# Shortest expected time of a design that is reported [s].
WORTH_A_LINE = 5.0

# Sections that are converted into one value each.
VALUES = ("material", "friction", "block", "limits", "tools", "contact", "part")


class Sections(Section):
    """All sections of a specification."""

    target: AnyTarget = key("the target friction law, of one of these kinds")
    material: sections.MaterialSection = key("the elastomer")
    friction: sections.FrictionSection | None = optional("needed for friction forces in N")
    lattice: sections.LatticeSection = key("sites of asperities")
    sites: sections.SitesSection = key(
        "sites that stay empty, and sites with given heights", default=sections.SitesSection()
    )
    tools: sections.ToolsSection | None = optional(
        "tools to choose from: their radii instead of lattice.radius, or exponents of power caps"
    )
    block: sections.BlockSection | None = optional("needed for the part files and the models layer and block")
    cell: sections.CellSection | None = optional("period of an infinite surface; default: no repetition")
    limits: sections.LimitsSection = key("manufacturing limits")
    layout: sections.LayoutSection = key("assignment of heights to sites", default=sections.LayoutSection())
    model: sections.ModelSection = key(
        "model under which the target is to be met", default=sections.ModelSection()
    )
    cap: ShapeSection | None = optional("shape of the caps, of one of these kinds; default: spheres")
    contact: ContactSection = key(
        "law of one contact, of one of these kinds; default: hertz", default=HertzSection(kind="hertz")
    )
    part: sections.PartSection = key("options of the part files", default=sections.PartSection())
    checks: sections.ChecksSection = key("further checks", default=sections.ChecksSection())

    def build(self) -> tuple[dict[str, Any], list[InvalidInput]]:
        """Return the members of a `Specification` by name, and the problems of the sections.

        The members are target, template, model, limits, tools, part and pinned.
        """
        problems: list[InvalidInput] = []

        def made(section: str, make: Callable[..., Any], *given: Any) -> Any:
            try:
                return make(*given)
            except InvalidInput as error:
                whole = not section or error.key.startswith("cell.")  # its own section
                problems.append(error if whole else error.within(section))
                return None

        found = {name: getattr(self, name) and made(name, getattr(self, name).value) for name in VALUES}
        limits, block, contact = found["limits"], found.pop("block"), found.pop("contact")
        if "contact" not in self.model_fields_set and self.cap is None:
            contact = default_contact(found["tools"])
        model = contact and made("model", model_named, self.model.kind, contact)
        # if one of these sections is wrong, a placeholder is used to check the other sections
        material = found.pop("material") or Material(1.0)
        friction = found.pop("friction") or (Friction(1.0) if self.friction else None)
        top = limits.offset + limits.max_height if limits else 1.0
        cap = (self.cap and made("cap", self.cap.value)) or SPHERE
        template = made("lattice", self._template, top, material, friction, block, cap)
        target = made("target", self.target.target, material, friction)
        pinned = None
        if template and limits:
            pinned = made("sites", self.sites.heights_by_site, template.count, limits, block is not None)
            if block and cap == SPHERE:
                made("", self._refuse_high_caps, limits)
            if found["tools"] and contact and not problems:
                made("", _refuse_tools, found["tools"], template, limits, contact)
            if self.tools is None and not problems:
                made("", _refuse_impossible, template, found["part"])
        parts = {"target": target, "template": template, "model": model, "pinned": pinned or {}}
        return {**found, **parts}, problems

    def _template(
        self, top: float, material: Material, friction: Friction | None, block: Block | None, cap: Cap
    ) -> Surface:
        """Return the lattice with all summits at the height `top` [mm] and with the smallest radius."""
        refuse_too_many(*self.lattice.shape)
        _, radii = self._radii()
        others: dict[str, Any] = {"material": material, "friction": friction, "block": block, "cap": cap}
        shape, pitch = self.lattice.shape, self.lattice.pitch
        if self.cell is not None:
            sides = (self.cell.width or shape[1] * pitch, self.cell.length or shape[0] * pitch)
            others["cell"] = PeriodicCell(*sides)
        return Surface.square_lattice(top, shape, pitch, radius=min(radii), **others)

    def _radii(self) -> tuple[str, Sequence[float]]:
        """Return the key that states the radii, and the radii or their bounds [mm]."""
        one, tools = self.lattice.radius, self.tools
        if tools is None or tools.exponent_range is not None:
            missing = "is missing" + ("" if tools else ", and there is no section [tools]")
            refuse_if(one is None, missing, key="radius", example='radius = "526 um"')
            return "lattice.radius", [one or 0.0]
        refuse_if(one is not None, "and [tools] both give radii; keep one", key="radius")
        if tools.radius_range is None:
            return "tools.radii", tools.radii or ()
        return "tools.radius_range", tools.radius_range

    def _refuse_high_caps(self, limits: Limits) -> None:
        """Raise InvalidInput if spheres could be higher than the largest radius."""
        source, radii = self._radii()
        refuse_if(
            limits.offset + limits.max_height > max(radii),
            "and {} together exceed the radius of {.number}: a cap cannot be higher than its radius; lower "
            "them, or omit [block] and with it the part files",
            Quantity("limits.offset", limits.offset),
            Quantity(source, max(radii)),
            key="limits.max_height",
            value=limits.max_height,
        )


def _refuse_impossible(template: Surface, part: PartOptions) -> None:
    """Raise InvalidInput if a part with all summits at the largest height cannot be made.

    The error names the key of the specification to change.
    """
    try:
        planned(template, template, part)
    except CannotBeMade as error:
        raise InvalidInput(f"does not suit the part: {error}", key=error.remedy) from None


def _refuse_tools(tools: Given, template: Surface, limits: Limits, contact: Contact) -> None:
    """Raise InvalidInput for tools whose caps overlap or are not described by the contact law."""
    try:
        refuse_misfits(Tools.of(tools, template, contact), template, limits.top)
    except InvalidInput as error:
        raise InvalidInput(f"do not suit: {error}", key="tools") from None


def refuse_too_many(rows: int, columns: int) -> None:
    """Raise InvalidInput for a lattice whose design is too large for a record or for the memory."""
    places, most = max(rows, 0) * max(columns, 0), RECORD // RECORDED
    shape = f"[{rows}, {columns}]"
    must = f"has {places:,} sites; at most {most:,} are allowed, so that the result can be read"
    refuse_if(places > most, must, key="shape", value=shape)
    try:
        require_memory(MEMORY * places, f"has {places:,} sites: their design")
    except InvalidInput as error:
        raise InvalidInput(f"{error}; use fewer sites", key="shape", value=shape) from None


def tell_cost(places: int) -> None:
    """Print the expected time and memory before a design of many sites."""
    if TIME * places >= WORTH_A_LINE:
        memory = f"{MEMORY * places / 2**30:.1f} GiB of memory"
        message(
            f"{places:,} sites: about {TIME * places:.0f} s and {memory} for the design and its files under "
            "the independent model; other models and the part take longer"
        )
