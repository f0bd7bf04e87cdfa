"""The whole specification: all its sections, and the values that are built from them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from pydantic import Field

from metafem import _validate as check
from metafem._given import error_section, formatted
from metafem.contact.cap_geometry import SPHERES
from metafem.errors import InvalidInput
from metafem.files.part.plan import planned
from metafem.files.specification.contacts import ContactSection, HertzSection
from metafem.files.specification.cost import refuse_too_many
from metafem.files.specification.fields import Section, says
from metafem.files.specification.models import model_named
from metafem.files.specification.sections import (
    BlockSection,
    ChecksSection,
    FrictionSection,
    LatticeSection,
    LayoutSection,
    LimitsSection,
    MaterialSection,
    ModelSection,
    PartSection,
    RadiiSection,
    RobustSection,
    SitesSection,
)
from metafem.files.specification.targets import (
    BilinearSection,
    LinearSection,
    MultilinearSection,
    PointsSection,
    PowerSection,
    SampledSection,
)
from metafem.inversion import Limits, RadiusRange
from metafem.models.model import PARABOLOID
from metafem.surface import Block, Friction, Material, Surface


class Sections(Section):
    """The whole file."""

    target: Annotated[
        PointsSection | LinearSection | BilinearSection | SampledSection | PowerSection | MultilinearSection,
        Field(discriminator="kind", description="the target friction law, of one of these kinds"),
    ]
    material: Annotated[MaterialSection, says("the elastomer")]
    friction: Annotated[FrictionSection | None, says("needed for friction forces in N")] = None
    lattice: Annotated[LatticeSection, says("sites of asperities")]
    sites: Annotated[SitesSection, says("sites that stay empty, and sites with given heights")] = (
        SitesSection()
    )
    radii: Annotated[RadiiSection | None, says("radii to choose from, instead of lattice.radius")] = None
    block: Annotated[
        BlockSection | None, says("needed for the part files and the models layer and block")
    ] = None
    limits: Annotated[LimitsSection, says("manufacturing limits")]
    layout: Annotated[LayoutSection, says("assignment of heights to sites")] = LayoutSection()
    robust: Annotated[
        RobustSection | None, says("errors of the part, under which the expected misfit is least")
    ] = None
    model: Annotated[ModelSection, says("model under which the target is to be met")] = ModelSection()
    contact: Annotated[
        ContactSection,
        Field(discriminator="kind", description="law of one contact, of one of these kinds; default: hertz"),
    ] = HertzSection(kind="hertz")
    part: Annotated[PartSection, says("options of the part files")] = PartSection()
    checks: Annotated[ChecksSection, says("further checks")] = ChecksSection()

    def build(self) -> tuple[dict[str, Any], list[str]]:
        """Return target, template, model, limits, layout, radii, robust, part and pinned, with problems."""
        problems: list[str] = []

        def made(section: str, kind: Any, values: dict[str, Any]) -> Any:
            try:
                with error_section(section):
                    return kind(**values)
            except InvalidInput as error:
                problems.append(f"{section}.{error}")
                return None

        material = made("material", self.material.material, {})
        friction = self.friction and made("friction", Friction, self.friction.model_dump())
        block = None if self.block is None else made("block", Block, self.block.model_dump())
        limits = made("limits", Limits, self.limits.model_dump())
        layout = made("layout", self.layout.layout, {})
        robust = self.robust and made("robust", self.robust.tolerances, {})
        contact, model = made("contact", self.contact.law, {}), None
        try:
            model = contact and model_named(self.model.kind, contact)
        except InvalidInput as error:
            problems.append(f"model {error}")
        # Placeholders, so that the other sections are checked even if one of these is wrong.
        top = limits.offset + limits.max_height if limits else 1.0
        stuff = material or Material(1.0)
        radius, radii, source = self._radius(problems)
        lost = self._lost_beside(radius, source, limits, block, problems)
        if self._too_many(problems) or lost:
            template = None
        else:
            others = {"material": stuff, "friction": friction, "block": block}
            lattice = {**self.lattice.model_dump(), "height": top, "radius": radius, **others}
            template = made("lattice", Surface.square_lattice, lattice)
        pair = friction or (Friction(1.0) if self.friction else None)
        target = made("target", self.target.target, {"material": stuff, "friction": pair})
        largest = radius if radii is None else radii.high if isinstance(radii, RadiusRange) else max(radii)
        shape = (contact or PARABOLOID).shape()
        if limits and block and not lost and shape is SPHERES and top > largest:
            heights = f"limits.offset + limits.max_height = {formatted('limits.max_height', top)}"
            problems.append(
                f"{heights} exceed the radius of {formatted(source, largest)}: a cap cannot be "
                "higher than its radius; lower them, or omit [block] and with it the part files"
            )
        pinned: dict[int, float | None] = {}
        if template and limits:
            pinned = self.sites.heights_by_site(template.count, limits, block is not None, problems)
        part = self.part.options()
        if block and template and template.count == 1 and part.alignment_height is not None:
            problems.append(
                "part.alignment_height needs a lattice of at least two sites, for its pitch; omit it"
            )
        if template and limits and radii is None and not problems:
            try:
                planned(template, template, part, contact or PARABOLOID)
            except InvalidInput as error:
                problems.append(_of_the_part(error, limits, block))
        parts = {"target": target, "template": template, "limits": limits, "layout": layout, "radii": radii}
        parts |= {"robust": robust, "part": part, "model": model, "pinned": pinned}
        return parts, problems

    def _radius(self, problems: list[str]) -> tuple[float, RadiusRange | tuple[float, ...] | None, str]:
        """Return the template's radius, the radii to choose from and their key; add problems to the list."""
        one = self.lattice.radius
        source, values = "lattice.radius", [one or 0.0]
        if self.radii is not None:
            source = "radii.tools" if self.radii.range is None else "radii.range"
            values = [*(self.radii.range or self.radii.tools or ())]
            if one is not None:
                problems.append("lattice.radius and [radii] both give radii; keep one")
        elif one is None:
            missing = 'write for example radius = "526 um", or a section [radii]'
            problems.append(f"lattice.radius is missing; {missing}")
            return 1.0, None, source
        try:
            values = [check.number(source, radius, above=0.0) for radius in values]
            check.proportion(source, max(values), source, min(values))
            given = None if self.radii is None else self.radii.radii()
        except InvalidInput as error:
            problems.append(str(error))
            return 1.0, None, source
        return min(values), given, source

    def _too_many(self, problems: list[str]) -> bool:
        """Return whether the lattice has too many sites, and add this to the problems."""
        rows, columns = self.lattice.shape
        try:
            refuse_too_many(max(0, rows) * max(0, columns))
        except InvalidInput as error:
            problems.append(f"lattice.shape = [{rows}, {columns}] {error}")
            return True
        return False

    def _lost_beside(
        self, radius: float, source: str, limits: Limits | None, block: Block | None, problems: list[str]
    ) -> bool:
        """Return whether lengths differ too much from the radius, and add them to the problems."""
        before = len(problems)
        heights = (
            {} if limits is None else {"limits.max_height": limits.max_height, "limits.offset": limits.offset}
        )
        sizes = {} if block is None else {f"block.{name}": size for name, size in asdict(block).items()}
        for name, size in {**heights, **sizes}.items():
            try:
                if radius > 0.0 and (size > radius or name in sizes):
                    check.proportion(name, size, source, radius)
            except InvalidInput as error:
                problems.append(str(error))
        return len(problems) > before


def _of_the_part(error: InvalidInput, limits: Limits, block: Block | None) -> str:
    """Return why no part can have summits of the largest height, beginning with the key to change."""
    words = str(error)
    if words.startswith("part."):
        return words
    key, highest = getattr(error, "key", "limits.max_height"), getattr(error, "highest", None)
    of_block = key.startswith("block.")
    given = f"{key} = {formatted(key, getattr(block if of_block else limits, key.rpartition('.')[2]))}"
    if limits.offset and not of_block:
        given += f" with limits.offset = {formatted('limits.offset', limits.offset)}"
    if highest is not None:
        most = formatted("limits.max_height", float(f"{max(0.0, highest - limits.offset):.3g}"))
        at_most = f"max_height can be at most {most}"
        if highest <= limits.offset:
            at_most = f"offset must be below {formatted('limits.offset', highest)}"
        return (
            f"{given}: caps of this height overlap; with this pitch, radius and offset {at_most}. Or "
            "increase the pitch, or omit [block] and with it the part files"
        )
    top = formatted("limits.max_height", limits.offset + limits.max_height)
    return f"{given}: with summits of {top}, {words}"
