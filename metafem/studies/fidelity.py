"""The law of one design under models of increasing detail."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import elementwise

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.inversion import Design
from metafem.models.model import contact_of, has_paraboloids
from metafem.notes import information
from metafem.progress import doing
from metafem.studies.cap_contact import CapContact, caps_of, solve_caps
from metafem.studies.sampling.dataset import dataset, described
from metafem.studies.substrates import laws_on_substrates
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Explanation of the model "fe", stored in the notes of the dataset.
ELEMENTS = (
    "fe: each contact has the law of its true cap on the bonded block by small-strain finite elements, "
    "without interaction; compare it with independent. At large a/R small strain overestimates P(a), while "
    "finite strain gives less than Hertz's law: the change of A0 is an upper estimate there, and Hertz's law "
    "with a fitted modulus is more accurate"
)


@doing("comparing the models")
def fidelity(design: Design, *, elements: bool = True) -> xr.Dataset:
    """Return A0(P) and delta(P) of a design under all models.

    The models are "independent", order 3 on the "half-space", the bonded "layer" and the true "block",
    and "fe". The influence of the true block is computed once (half a minute for 64 asperities) and stored
    on disk.

    "fe" denotes independent asperities with the contact law of the true spherical cap on the bonded block
    instead of Hertz's law: ``sum_i P_fe(a_i, h_i) = P`` with ``d_fe(a_i, h_i) = h_i - delta``. The contact
    law is interpolated between axisymmetric finite-element solutions (`metafem.fe.press`) at nine pairs of
    height and contact radius. It includes the effects of the shape of the cap, its pedestal, and the base and
    the sides of the block, but not of neighbouring asperities. The difference from "independent" is
    meaningful at small a/R. At large a/R the difference is an upper estimate: at a/R = 0.5, the load is 1.11
    times Hertz's load at small strain, but 0.978 times Hertz's load at finite strain.

    Parameters
    ----------
    design : Design
    elements : bool
        Whether to compute "fe", which takes about half a minute for each radius of the summits. With more
        than four radii, "fe" is left out. Default: True.

    Returns
    -------
    xarray.Dataset
        ``area`` [mm^2], ``separation`` [mm], ``area_change`` [-] (relative to independent asperities) and
        ``sinking`` [mm] (the decrease of the separation), over ``model`` and ``rescaled_load`` [mm^2], with
        the coordinate ``load`` [N]. ``elements_error`` [-] is the largest relative error of load and
        indentation in the table of caps. The attribute ``notes`` has one line for each model that was left
        out, with the reason.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> fidelity(design, elements=False).model.values.tolist()
    ['independent', 'half-space']
    """
    surface, load = design.surface, design.law.load
    model = design.law.model
    laws, notes = laws_on_substrates(surface, load, contact_of(model), wait=True)
    area = {name: law.area for name, law in laws.items()}
    separation = {name: law.separation for name, law in laws.items()}
    error = float("nan")
    if elements and not has_paraboloids(model):
        notes.append(information("fe is left out: its caps are spherical, to be compared with paraboloids"))
    elif elements:
        try:
            # 1.2 times Hertz's indentation: on the source paper's surfaces, pedestals add up to a fifth
            caps = caps_of(surface, 1.2 * (surface.height - separation["independent"][-1]))
            area["fe"], separation["fe"] = _law_of_caps(surface, caps, design.law.rescaled_load)
            error = max(table.error for table in caps.values())
            notes.append(information(ELEMENTS))
        except InvalidInput as reason:
            notes.append(information(f"fe is left out: {reason}"))
    names = list(area)
    areas, separations = (np.array([part[name] for name in names]) for part in (area, separation))
    axes = ("model", "rescaled_load")
    variables = {
        "area": (axes, areas),
        "separation": (axes, separations),
        "area_change": (axes, areas / areas[0] - 1.0),
        "sinking": (axes, separations[0] - separations),
        "elements_error": ((), error),
    }
    rescaled = design.law.rescaled_load
    coordinates = {"model": names, "rescaled_load": rescaled}
    found = dataset("fidelity", variables, coordinates, notes=notes)
    return found.assign_coords(load=("rescaled_load", load, described("load")))


def _law_of_caps(
    surface: Surface, caps: Mapping[float, CapContact], rescaled_load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return areas [mm^2] and separations [mm] (k,) of independent asperities with tabulated laws."""
    top = float(surface.height.max())

    def missing(separation: FloatArray, load: FloatArray) -> FloatArray:
        indentation = surface.height[:, None] - separation
        return np.asarray(solve_caps(surface, caps, indentation)[1].sum(axis=0) - load)

    start, given = np.full(len(rescaled_load), top), (rescaled_load,)
    ends = elementwise.bracket_root(missing, 0.98 * start, start, xmax=start, args=given).bracket
    separation = elementwise.find_root(missing, ends, args=given).x
    radius = solve_caps(surface, caps, surface.height[:, None] - separation)[0]
    return np.pi * (radius**2).sum(axis=0), separation
