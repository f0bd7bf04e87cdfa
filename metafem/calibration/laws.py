"""Measured friction laws: points with error bars, from arrays or from the contacts in images."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import span
from metafem.calibration.contact_table import by_image, listed
from metafem.calibration.statistics import PAPER, MeasurementErrors
from metafem.drawing import MEASURED, calibration, name_law
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.notes import Note, counted, to_lines
from metafem.prediction import friction_law
from metafem.prediction.base_law import BaseLaw
from metafem.surface import Friction, Material, Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from metafem.models import Model

# Quantities of a measured law.
QUANTITIES = ("load", "friction_force", "asperity_area", "area")

# Number of standard deviations by which a force or an area may lie below zero. One normal error in a million
# is larger.
BELOW_ZERO = 5.0

# A load without contact has an error too: the standard deviation of a total area is at least the value for
# this fraction of the largest area.
SMALL_CONTACT = 0.01

# Default of a field that is computed from other fields.
COMPUTED: Any = None


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredLaw(BaseLaw):
    """Measured friction law of a part: friction forces or contact areas at k loads, with error bars.

    The rescaled friction is ``F/(sigma B)`` if the friction force F was measured, else the contact area A0.
    The rescaled load is ``P/E*``. The standard deviations include the errors of measurement only. Errors of
    E*, sigma and B shift all points together; `compare` takes them into account. Aymard et al., Science 383,
    200 (2024), doi:10.1126/science.adk4234, Figs. 3 to 5.

    Parameters
    ----------
    load : array_like, (k,)
        Normal loads P [N], in any order; the law sorts them in increasing order.
    friction_force : array_like, (k,), optional
        Friction forces F [N].
    area : array_like, (k,), optional
        Real contact areas A0 [mm^2]; default: the sums of `asperity_area`.
    asperity_area : array_like, (k, n), optional
        Contact area of each asperity [mm^2]; 0 for an open contact and, if friction forces were measured, nan
        for an area that could not be measured.
    site : array_like of int, (n,), optional
        Numbers of the asperities in the design; default: 0 to n - 1.
    material : Material
    friction : Friction, optional
        Friction with sigma and B; required to rescale friction forces.
    errors : MeasurementErrors
        Errors that provide the standard deviations that are not passed; default: the error bars of the paper.
    load_sd, friction_force_sd, area_sd, asperity_area_sd : array_like, optional
        Standard deviations in the units and shapes of the quantities, positive. For an open contact, the
        largest area that may have been overlooked, or 0.
    notes : tuple of Note
        Notes on what was left out.

    Attributes
    ----------
    rescaled_load, rescaled_load_sd : ndarray, (k,)
        P/E* and its standard deviation [mm^2].
    rescaled_friction, rescaled_friction_sd : ndarray, (k,)
        F/(sigma B) or A0, and its standard deviation [mm^2].

    Raises
    ------
    InvalidInput
        If neither friction forces nor areas are passed, if the shapes of arrays do not match, if a standard
        deviation is not positive, if a value is below zero by more than five standard deviations, or if there
        are friction forces but neither `friction` nor areas.

    Examples
    --------
    >>> import metafem as mf
    >>> law = MeasuredLaw(
    ...     [0.1, 0.2], friction_force=[0.05, 0.09],
    ...     material=mf.Material(1.36), friction=mf.Friction(0.404, 0.85),
    ... )
    >>> law.rescaled_friction.round(4), law.rescaled_friction_sd.round(4)
    (array([0.1456, 0.2621]), array([0.0044, 0.0055]))
    >>> law
    <MeasuredLaw: 2 loads 0.1 to 0.2 N, friction force 0.05 to 0.09 N, no notes>
    """

    load: FloatArray
    _: KW_ONLY
    friction_force: FloatArray | None = None
    area: FloatArray | None = None
    asperity_area: FloatArray | None = None
    site: NDArray[np.intp] | None = None
    material: Material
    friction: Friction | None = None
    errors: MeasurementErrors = PAPER
    load_sd: FloatArray = COMPUTED
    friction_force_sd: FloatArray | None = None
    area_sd: FloatArray | None = None
    asperity_area_sd: FloatArray | None = None
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        check.instance("material", self.material, Material, "a metafem.Material")
        check.instance("friction", self.friction, Friction, "a metafem.Friction, or None", optional=True)
        check.instance("errors", self.errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
        found: dict[str, Any] = {"load": check.array("load", self.load, shape=(None,))}
        shape = found["load"].shape
        if self.asperity_area is not None:
            checked = check.array if self.friction_force is None else check.array_with_gaps
            areas = checked("asperity_area", self.asperity_area, shape=(*shape, None))
            must = "must be at least 0; 0 is an open contact"
            check.refuse_entries("asperity_area", areas, areas < 0.0, must)
            count = areas.shape[1]
            site = np.arange(count) if self.site is None else np.array(self.site)
            wrong = site.shape != (count,) or site.dtype.kind not in "iu" or (site < 0).any()
            must = f"must hold a different number of the design for each of the {count} asperities"
            refuse_if(wrong or len(np.unique(site)) < count, f"site = {shown(self.site)} {must}")
            found |= {"asperity_area": areas, "site": site.astype(np.intp)}
            if not np.isnan(areas).any():
                found["area"] = areas.sum(axis=1)
        for name in ("friction_force", "area"):
            if getattr(self, name) is not None:
                found[name] = check.array(name, getattr(self, name), shape=shape)
        refuse_if(len(found) < 2, "a measured law needs friction_force, area or asperity_area")
        for name in QUANTITIES:
            alone = name not in found and getattr(self, f"{name}_sd") is not None
            refuse_if(alone, f"{name}_sd needs {name}")
            if name in found:
                found[f"{name}_sd"] = self._deviation(name, found)
            if name in found and name != "asperity_area":
                below = found[name] < -BELOW_ZERO * found[f"{name}_sd"]
                must = "is below 0 by more than five standard deviations; check the sign of the force or the"
                check.refuse_entries(name, found[name], below, f"{must} zero of the instrument")
        order = np.argsort(found["load"], kind="stable")
        for name, values in found.items():
            ordered = values if name == "site" else values[order]
            ordered.flags.writeable = False
            object.__setattr__(self, name, ordered)
        refuse_if(
            self.area is None and self.friction is None,
            "friction_force can only be rescaled with the friction of the material pair; add "
            "friction=metafem.Friction(shear_strength, area_ratio)",
        )

    def __repr__(self) -> str:
        what = f"area {span(self.rescaled_friction, 'mm^2')}"
        if self.friction_force is not None:
            what = f"friction force {span(self.friction_force, 'N')}"
        return f"<MeasuredLaw: {len(self.load)} loads {span(self.load, 'N')}, {what}, {counted(self.notes)}>"

    def _deviation(self, name: str, found: Mapping[str, Any]) -> FloatArray:
        """Return the standard deviations of a quantity, as passed or computed from `errors`."""
        values, sd, errors = found[name], getattr(self, f"{name}_sd"), self.errors
        if sd is not None:
            # the standard deviation of an open contact may be 0
            return check.array(f"{name}_sd", sd, shape=values.shape, positive=name != "asperity_area")
        of = {"load": errors.of_load, "friction_force": errors.of_friction_force}.get(name, errors.of_area)
        if name != "area":
            return of(values)
        refuse_if(not values.max() > 0.0, f"area is {values.max():g} mm^2 at most: there is no contact")
        total = errors.of_area(values)
        if self.area is None:
            closed = np.where(found["asperity_area"] > 0.0, found["asperity_area_sd"], 0.0)
            total = np.linalg.norm(closed, axis=1)
        return np.maximum(total, errors.of_area(SMALL_CONTACT * values.max()))

    def only(self, chosen: NDArray[np.bool_]) -> MeasuredLaw:
        """Return the law at some of its loads, (k,)."""
        arrays = {f"{name}{sd}": getattr(self, f"{name}{sd}") for name in QUANTITIES for sd in ("", "_sd")}
        return replace(self, **{name: of[chosen] for name, of in arrays.items() if of is not None})

    def computed(
        self, surface: Surface, model: Model, largest: float = np.inf
    ) -> tuple[FloatArray, FloatArray]:
        """Return the contact areas of a surface at the loads, and their mean slopes over the error bars.

        Loads above the `largest` one [N] are not used.
        """
        load, sd = self.load, self.load_sd
        middle, low, high = (np.clip(each, 0.0, largest) for each in (load, load - sd, load + sd))
        # if an error bar lies entirely below 0, use the slope at the smallest loads
        high = np.where(high > low, high, np.minimum(sd, largest))
        loads, place = np.unique(np.concatenate([middle, low, high]), return_inverse=True)
        area, at_low, at_high = friction_law(surface, model, load=loads).area[place].reshape(3, -1)
        return area, (at_high - at_low) / (high - low)

    @property
    def stress_of_forces(self) -> float:
        """Friction force over rescaled friction, sigma B [MPa], if forces were measured; else 0."""
        return 0.0 if self.friction_force is None or self.friction is None else self.friction.stress

    @property
    def rescaled_load(self) -> FloatArray:
        """Rescaled load P/E* [mm^2], (k,)."""
        return self.load / self.material.composite_modulus

    @property
    def rescaled_load_sd(self) -> FloatArray:
        """Standard deviation of P/E* [mm^2], without the error of E*."""
        return self.load_sd / self.material.composite_modulus

    @property
    def rescaled_friction(self) -> FloatArray:
        """Rescaled friction: F/(sigma B) if friction forces were measured, else A0 [mm^2], (k,)."""
        return self._rescaled("")

    @property
    def rescaled_friction_sd(self) -> FloatArray:
        """Standard deviation of the rescaled friction [mm^2], without the errors of sigma and B."""
        return self._rescaled("_sd")

    def _rescaled(self, suffix: str) -> FloatArray:
        stress = self.stress_of_forces
        measured = getattr(self, f"friction_force{suffix}" if stress else f"area{suffix}")
        return np.asarray(measured / (stress or 1.0))

    def _force(self, suffix: str = "") -> FloatArray:
        """Return friction forces, measured or sigma B times areas, or their standard deviations [N]."""
        if self.friction_force is not None:
            return np.asarray(getattr(self, f"friction_force{suffix}"))
        if self.friction is None:
            raise InvalidInput(
                "the friction force was not measured; to compute it from the areas, give the law "
                "friction=metafem.Friction(shear_strength, area_ratio)"
            )
        return np.asarray(self.friction.stress * getattr(self, f"area{suffix}"))

    def quantities(self) -> dict[str, FloatArray]:
        """Return the arrays (k,) of the law by name, in the order of table columns."""
        found: dict[str, FloatArray] = {}
        for name in ("load", "area", "rescaled_load", "rescaled_friction", "friction_force"):
            if getattr(self, name) is not None:
                found |= {name: getattr(self, name), f"{name}_sd": getattr(self, f"{name}_sd")}
        if self.friction_force is not None:
            found["friction_coefficient"] = self.friction_coefficient
        return found

    def _about(self) -> dict[str, str]:
        return {"notes": to_lines(self.notes)}

    def _draw(self, ax: Axes, forces: bool, label: str | None) -> None:
        points = self.rescaled_load, self.rescaled_friction, self.rescaled_load_sd, self.rescaled_friction_sd
        if forces:
            points = self.load, self._force(), self.load_sd, self._force("_sd")
        calibration.measured(ax, *points, label, MEASURED)
        name_law(ax, forces=forces)


def measured_law(
    table: DataFrame,
    material: Material,
    friction: Friction | None = None,
    sites: ArrayLike | None = None,
) -> MeasuredLaw:
    """Return the measured law of contacts found in images.

    The area at a load is the sum over the contacts. Images without a load are left out. If some images have
    a friction force and `friction` is passed, images without a friction force are left out too. The notes
    name these images. The areas of contacts without a site contribute to the sums only.

    Parameters
    ----------
    table : DataFrame
        Contacts as `contact_table` returns them.
    material : Material
    friction : Friction, optional
    sites : array_like of int, (n,), optional
        Sites of the asperities of the design (``Design.sites``), required for a table of `metafem images` if
        the design leaves sites empty. Default: each asperity has the number of its site.

    Returns
    -------
    MeasuredLaw

    Raises
    ------
    InvalidInput
        If no image has a load together with a friction force or the required areas, or if a site is not in
        `sites`.

    Examples
    --------
    >>> import pandas as pd
    >>> from metafem import Material
    >>> from metafem.calibration import contact_table
    >>> forces = pd.DataFrame({"image": ["1.tif"], "test": "", "load": 0.05, "friction_force": np.nan})
    >>> table = contact_table(forces, [[0.0, 0.0], [1.5, 0.0]], [0, 1], [[0.1, 0.0]], [[1e-3, 0.0]])
    >>> measured_law(table, Material(1.36)).area
    array([0.1])
    """
    from pandas import Index

    images, areas = by_image(table)
    area, error, force = areas["area"], areas["area_error"], images["friction_force"].to_numpy()
    by_force = friction is not None and bool(np.isfinite(force).any())
    whole: Any = np.isfinite(area).all(axis=1)
    used = images["load"].notna().to_numpy() & (np.isfinite(force) if by_force else whole)
    what = "a friction force" if by_force else "the areas of all its contacts"
    refuse_if(not used.any(), f"none of the {len(used)} images has a load and {what}")
    left = listed(images["image"][~used])
    notes = [Note(f"images without a load and {what} are left out: {left}")] * bool(left)
    area, error = area[used], np.nan_to_num(error[used])
    found: dict[str, Any] = {"load": images["load"][used]}
    if np.isfinite(force[used]).all():
        found["friction_force"] = force[used]
    site = table["site"][: area.shape[1]]
    if site.notna().all():
        number = site.to_numpy(dtype=np.int64)
        asperity = number if sites is None else Index(np.asarray(sites)).get_indexer(number)
        wrong = listed(map(str, number[asperity < 0] + 1))
        refuse_if(wrong, f"the contacts have site {wrong}, which the design leaves empty or does not have")
        found |= {"asperity_area": area, "asperity_area_sd": error, "site": asperity}
    if whole[used].all():
        found["area"] = area.sum(axis=1)
        sd = np.linalg.norm(np.where(area > 0.0, error, 0.0), axis=1)  # without errors of open contacts
        if (sd > 0.0).all():  # an image without contacts has sd 0: use the default errors then
            found["area_sd"] = sd
    return MeasuredLaw(**found, material=material, friction=friction, notes=tuple(notes))
