"""Surfaces with a friction law of your choice.

metafem inverts a wanted friction law into the heights of spherical asperities, predicts the law of a
surface under models of increasing truth, and writes the files to make the part.

Units are mm, N and MPa everywhere, angles are in radians, compression is positive. The separation is
the distance from the rigid plane to the undeformed base plane of the asperities; the approach is the
tallest summit minus the separation. *Rescaled* means load P/E* and friction F/(sigma B) = A0, both in
mm^2.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from metafem import fe as fe
    from metafem import studies as studies
    from metafem.asperity import Hertz as Hertz
    from metafem.errors import Infeasible as Infeasible
    from metafem.errors import InvalidInput as InvalidInput
    from metafem.errors import MetafemError as MetafemError
    from metafem.errors import MetafemWarning as MetafemWarning
    from metafem.errors import NotConverged as NotConverged
    from metafem.files import load as load
    from metafem.files import read_spec as read_spec
    from metafem.files import save as save
    from metafem.inversion import Arrangement as Arrangement
    from metafem.inversion import BilinearLaw as BilinearLaw
    from metafem.inversion import FollowLaw as FollowLaw
    from metafem.inversion import InsensitiveToTilt as InsensitiveToTilt
    from metafem.inversion import Layout as Layout
    from metafem.inversion import Limits as Limits
    from metafem.inversion import LinearLaw as LinearLaw
    from metafem.inversion import MultilinearLaw as MultilinearLaw
    from metafem.inversion import OperatingPoints as OperatingPoints
    from metafem.inversion import PowerLaw as PowerLaw
    from metafem.inversion import RadiusRange as RadiusRange
    from metafem.inversion import SampledLaw as SampledLaw
    from metafem.inversion import Together as Together
    from metafem.inversion import achievable_friction_coefficients as achievable_friction_coefficients
    from metafem.inversion import arrange as arrange
    from metafem.inversion import design_radii as design_radii
    from metafem.inversion import design_radius as design_radius
    from metafem.inversion import feasible_region as feasible_region
    from metafem.inversion import plasticity_index as plasticity_index
    from metafem.inversion.design import Design as Design
    from metafem.inversion.design import design as design
    from metafem.law import FrictionLaw as FrictionLaw
    from metafem.law import friction_law as friction_law
    from metafem.models import Automatic as Automatic
    from metafem.models import BoundaryElements as BoundaryElements
    from metafem.models import ContactState as ContactState
    from metafem.models import Independent as Independent
    from metafem.models import Interacting as Interacting
    from metafem.models import MeanField as MeanField
    from metafem.models import Status as Status
    from metafem.models.equilibrium import equilibrium as equilibrium
    from metafem.notes import Note as Note
    from metafem.substrate import BondedLayer as BondedLayer
    from metafem.substrate import HalfSpace as HalfSpace
    from metafem.surface import Block as Block
    from metafem.surface import Friction as Friction
    from metafem.surface import Material as Material
    from metafem.surface import Surface as Surface

# Where each public name lives: read when it is first used, so that `metafem --help` loads no numpy.
_HOME = {
    "metafem.asperity": ("Hertz",),
    "metafem.errors": (
        "Infeasible",
        "InvalidInput",
        "MetafemError",
        "MetafemWarning",
        "NotConverged",
    ),
    "metafem.files": ("load", "read_spec", "save"),
    "metafem.inversion": (
        "Arrangement",
        "BilinearLaw",
        "FollowLaw",
        "InsensitiveToTilt",
        "Design",
        "Layout",
        "Limits",
        "LinearLaw",
        "MultilinearLaw",
        "OperatingPoints",
        "PowerLaw",
        "RadiusRange",
        "SampledLaw",
        "Together",
        "achievable_friction_coefficients",
        "arrange",
        "design",
        "design_radii",
        "design_radius",
        "feasible_region",
        "plasticity_index",
    ),
    "metafem.law": ("FrictionLaw", "friction_law"),
    "metafem.models": (
        "Automatic",
        "BoundaryElements",
        "ContactState",
        "Independent",
        "Interacting",
        "MeanField",
        "Status",
        "equilibrium",
    ),
    "metafem.notes": ("Note",),
    "metafem.substrate": ("BondedLayer", "HalfSpace"),
    "metafem.surface": ("Block", "Friction", "Material", "Surface"),
}
_MODULE = {name: module for module, names in _HOME.items() for name in names}

# Parts that are used under their own name, such as mf.fe.press.
_PARTS = ("fe", "studies")

__all__ = sorted([*_MODULE, *_PARTS])


def __getattr__(name: str) -> Any:
    if name in _PARTS:
        return import_module(f"metafem.{name}")
    if name not in _MODULE:
        raise AttributeError(f"module 'metafem' has no attribute {name!r}")
    value = getattr(import_module(_MODULE[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
