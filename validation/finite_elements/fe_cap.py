"""The true spherical cap on the bonded block, at small strain."""

from __future__ import annotations

from skfem import MeshQuad

from metafem import fe
from validation.check import Claim, Picture
from validation.finite_elements.checks import BLOCK_RADIUS, CAP_ROWS, RADIUS, THICKNESS, cap_check
from validation.finite_elements.frozen_meshes import CAP_CONTACT, FOLDER, cap
from validation.finite_elements.pictures import cap_pressure_figure, mesh_figure

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """The true spherical cap on the bonded block is computed at small strain with the contact radius
    prescribed. Its load is compared with that of an active set with other elements, on another mesh, at the
    same indentation, and the same sphere on a half-space with Sneddon's closed form. At small strain the load
    of the cap is 1.6 to 11 % above that of Hertz's law at the same contact radius; large strain takes this
    back, see the claim on the soft cap.
    """
    return Claim(
        "Finite elements: the spherical cap on the bonded block",
        cap_check(),
        {"Mesh of the cap": Picture(_mesh), "Pressure below the cap": Picture(_pressure)},
    )


def _mesh():
    """Left: elements of the cap and the block below it, height over radius [mm]. Right: the elements at the
    edge of the contact, where they become small because the pressure falls there as a square root.
    """
    return mesh_figure(MeshQuad.load(FOLDER / "cap.vtu"), cap(), CAP_CONTACT)


def _pressure():
    """Contact pressure over E* below two caps, over the radius relative to the contact radius, with Hertz's
    pressure at the same contact radius (dashed). The small contact on the low cap is close to Hertz's; at
    half the radius of the sphere the pressure of small strain exceeds it by 6 % in the centre.
    """
    contacts = [
        (fe.press(a, RADIUS, height=height, thickness=THICKNESS, block_radius=BLOCK_RADIUS), height)
        for height, a in CAP_ROWS
    ]
    return cap_pressure_figure(contacts, RADIUS)
