"""Contacts of asperities that do not interact, at all loads of a curve."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.models.adhesion.curves import adhesive_law, lone_curve
from metafem.models.adhesion.lone import Lone
from metafem.models.independent import Independent


def contacts_alone(
    law: Contact, height: FloatArray, radius: FloatArray, load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return contact radii and indentations (k, n) [mm] at increasing rescaled loads (k,) [mm^2].

    `law` is that for unit E*, heights and radii are (n,). An open contact has the radius 0 and the
    indentation minus its gap.
    """
    gap = height.max() - height
    adhesive = adhesive_law(law)
    if adhesive is not None:
        found = lone_curve(Lone(adhesive, np.broadcast_to(radius, gap.shape), gap), load, True, False, 1.0)
        return found.sums.contact_radius, found.approach[:, None] - gap
    approach = Independent().curve_of(height, radius, load, law).approach
    indentation = approach[:, None] - gap
    return np.asarray(law.contact_radius(indentation, radius)), indentation
