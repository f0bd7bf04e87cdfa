"""The whole specification: all its sections, and the values that are built from them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from pydantic import Field

from metafem import _validate as check
from metafem._given import Given
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
    contact: Annotated[ContactSection, says("law of one contact, of one of these kinds; default: hertz")] = (
        HertzSection(kind="hertz")
    )
    part: Annotated[PartSection, says("options of the part files")] = PartSection()
    checks: Annotated[ChecksSection, says("further checks")] = ChecksSection()

    def build(self) -> tuple[dict[str, Any], list[InvalidInput]]:
        """Return target, template, model, limits, layout, radii, robust, part and pinned, with problems."""
        problems: list[InvalidInput] = []

        def made(section: str, kind: Any, values: dict[str, Any]) -> Any:
            try:
                return kind(**values)
            except InvalidInput as error:
                problems.append(error.within(section))
                return None

        material = made("material", self.material.material, {})
        friction = self.friction and made("friction", Friction, self.friction.model_dump())
        block = None if self.block is None else made("block", Block, self.block.model_dump())
        limits = made("limits", Limits, self.limits.model_dump())
        layout = made("layout", self.layout.layout, {})
        robust = self.robust and made("robust", self.robust.tolerances, {})
        contact = made("contact", self.contact.law, {})
        model = contact and made("model", model_named, {"name": self.model.kind, "contact": contact})
        # Placeholders, so that the other sections are checked even if one of these is wrong.
        top = limits.offset + limits.max_height if limits else 1.0
        stuff = material or Material(1.0)
        radius, source = self._radius(problems)
        radii = made("radii", self.radii.radii, {}) if self.radii and source else None
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
            problems.append(
                InvalidInput(
                    "and {} together exceed the radius of {.number}: a cap cannot be higher than its radius; "
                    "lower them, or omit [block] and with it the part files",
                    Given("limits.offset", limits.offset),
                    Given(source, largest),
                    key="limits.max_height",
                    value=limits.max_height,
                )
            )
        pinned: dict[int, float | None] = {}
        if template and limits:
            pinned = self.sites.heights_by_site(template.count, limits, block is not None, problems)
        part = self.part.options()
        if block and template and template.count == 1 and part.alignment_height is not None:
            words = "needs a lattice of at least two sites, for its pitch; omit it"
            problems.append(InvalidInput(words, key="part.alignment_height"))
        if template and limits and radii is None and not problems:
            try:
                planned(template, template, part, contact or PARABOLOID)
            except InvalidInput as error:
                problems.append(_of_the_part(error, limits, block))
        parts = {"target": target, "template": template, "limits": limits, "layout": layout, "radii": radii}
        parts |= {"robust": robust, "part": part, "model": model, "pinned": pinned}
        return parts, problems

    def _radius(self, problems: list[InvalidInput]) -> tuple[float, str]:
        """Return the radius of the template and its key; the key is "" if there is a problem."""
        one = self.lattice.radius
        source, values = "lattice.radius", [one or 0.0]
        if self.radii is not None:
            source = "radii.tools" if self.radii.range is None else "radii.range"
            values = [*(self.radii.range or self.radii.tools or ())]
            if one is not None:
                problems.append(InvalidInput("and [radii] both give radii; keep one", key="lattice.radius"))
        elif one is None:
            example = 'radius = "526 um", or a section [radii]'
            problems.append(InvalidInput("is missing", key="lattice.radius", example=example))
            return 1.0, ""
        try:
            values = [check.number(source, radius, above=0.0) for radius in values]
            check.proportion(source, max(values), source, min(values))
        except InvalidInput as error:
            problems.append(error)
            return 1.0, ""
        return min(values), source

    def _too_many(self, problems: list[InvalidInput]) -> bool:
        """Return whether the lattice has too many sites, and add this to the problems."""
        rows, columns = self.lattice.shape
        try:
            refuse_too_many(max(0, rows) * max(0, columns))
        except InvalidInput as error:
            words = InvalidInput(error.must, key="lattice.shape", value=f"[{rows}, {columns}]")
            problems.append(words)
            return True
        return False

    def _lost_beside(
        self,
        radius: float,
        source: str,
        limits: Limits | None,
        block: Block | None,
        problems: list[InvalidInput],
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
                    check.proportion(name, size, source or "lattice.radius", radius)
            except InvalidInput as error:
                problems.append(error)
        return len(problems) > before


def _of_the_part(error: InvalidInput, limits: Limits, block: Block | None) -> InvalidInput:
    """Return the reason why no part can have summits of the largest height, with the key to change."""
    if error.key:
        return error
    key, highest = getattr(error, "remedy", "limits.max_height"), getattr(error, "highest", None)
    if key.startswith("block."):
        return InvalidInput(f"is too small: {error}", key=key, value=getattr(block, key.rpartition(".")[2]))
    offset = Given("limits.offset", limits.offset)
    given: dict[str, Any] = {"key": key, "value": limits.max_height}
    if highest is None:
        top = Given("limits.max_height", limits.offset + limits.max_height)
        return InvalidInput(f"with {{}} makes summits of {{.number}}: {error}", offset, top, **given)
    at_most = "max_height can be at most {.number}"
    most = Given("limits.max_height", float(f"{highest - limits.offset:.3g}"))
    if highest <= limits.offset:
        at_most, most = "offset must be below {.number}", Given("limits.offset", highest)
    return InvalidInput(
        f"with {{}} makes caps overlap; with this pitch, radius and offset {at_most}. Or increase the pitch, "
        "or omit [block] and with it the part files",
        offset,
        most,
        **given,
    )
