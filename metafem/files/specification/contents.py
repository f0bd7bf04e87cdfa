"""All sections of a specification, and the values that are built from them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from metafem.caps import SPHERE, Cap
from metafem.contact import Contact
from metafem.errors import InvalidInput, refuse_if
from metafem.files.part.plan import PartOptions, planned
from metafem.files.reading import RECORD
from metafem.files.specification import sections
from metafem.files.specification.fields import Section, key, optional
from metafem.files.specification.models import model_named
from metafem.files.specification.targets import AnyTarget
from metafem.inversion import Limits
from metafem.inversion.tools import Tools, default_contact, refuse_misfits
from metafem.models._resources import require_memory
from metafem.surface import Block, Friction, Material, PeriodicCell, Surface

# Cost of one site: size of its record and peak memory of its design [bytes], measured under the independent
# model on lattices of 10^5 and 10^6 sites.
RECORDED, MEMORY = 250, 1_800


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
    cap: sections.ShapeSection | None = optional("shape of the caps, of one of these kinds; default: spheres")
    contact: sections.ContactSection = key(
        "law of one contact, of one of these kinds; default: hertz",
        default=sections.HertzSection(kind="hertz"),
    )
    part: sections.PartSection = key("options of the part files", default=sections.PartSection())
    checks: sections.ChecksSection = key("further checks", default=sections.ChecksSection())

    def build(self) -> dict[str, Any]:
        """Return the members of a `Specification` by name.

        They are target, template, model, limits, tools, part and pinned. Raise InvalidInput for the first
        problem between sections; its key begins with the section.
        """
        material, limits, part = self.material.value(), self.limits.value(), self.part.value()
        friction = None if self.friction is None else self.friction.value()
        block = None if self.block is None else self.block.value()
        tools = None if self.tools is None else self.tools.value()
        contact, cap = self.contact.value(), SPHERE if self.cap is None else self.cap.value()
        if "contact" not in self.model_fields_set and self.cap is None:
            contact = default_contact(tools)
        with within("target"):
            target = self.target.target(material, friction)
        with within("model"):
            model = model_named(self.model.kind, contact, block)
        with within("lattice"):
            template = self._template(limits.top, material, friction, block, cap)
        with within("sites"):
            pinned = self.sites.heights_by_site(template.count, limits, block is not None)
        self._refuse_impossible(template, limits, part, contact)
        found = {"target": target, "template": template, "model": model, "limits": limits, "tools": tools}
        return {**found, "part": part, "pinned": pinned}

    def _template(
        self, top: float, material: Material, friction: Friction | None, block: Block | None, cap: Cap
    ) -> Surface:
        """Return the lattice with all summits at the height `top` [mm] and with the smallest radius."""
        rows, columns = self.lattice.shape
        refuse_too_many(rows, columns)
        _, radii = self._radii()
        others: dict[str, Any] = {"material": material, "friction": friction, "block": block, "cap": cap}
        shape, pitch = (rows, columns), self.lattice.pitch
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

    def _refuse_impossible(
        self, template: Surface, limits: Limits, part: PartOptions, contact: Contact
    ) -> None:
        """Raise InvalidInput if a part with all summits at the largest height cannot be made."""
        source, radii = self._radii()
        words = (
            f"and limits.offset = {limits.offset:g} mm together exceed {source} = {max(radii):g} mm: a cap "
            "cannot be higher than its radius; lower them, or omit [block] and with it the part files"
        )
        high = template.block is not None and template.cap == SPHERE and limits.top > max(radii)
        refuse_if(high, words, key="limits.max_height", value=limits.max_height)
        if self.tools is not None:
            try:
                refuse_misfits(Tools.of(self.tools.value(), template, contact), template, limits.top)
            except InvalidInput as error:
                raise InvalidInput(f"do not suit: {error}", key="tools") from None
            return
        planned(template, template, part)


@contextmanager
def within(section: str) -> Iterator[None]:
    """Make errors of the body concern keys of a section."""
    try:
        yield
    except InvalidInput as error:
        if error.key.partition("[")[0] in ("width", "length") and section == "lattice":
            section = "cell"  # its sides follow from the lattice
        raise error.within(section) from None


def refuse_too_many(rows: int, columns: int) -> None:
    """Raise InvalidInput for a lattice whose design is too large for a record or for the memory."""
    places, most = max(rows, 0) * max(columns, 0), RECORD // RECORDED
    shape = f"[{rows}, {columns}]"
    must = f"has {places:,} sites; at most {most:,} are allowed, so that the result can be read"
    refuse_if(places > most, must, key="shape", value=shape)
    require_memory(MEMORY * places, f"shape = {shape}: use fewer sites, because their design")
