"""Texts and data of a design: its model, misfit, notes, parameters, fitted slopes and onset of sliding."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np

from metafem._values import MICROMETRES, percent, three_digits
from metafem.errors import MetafemWarning
from metafem.inversion import Design, plasticity_index
from metafem.inversion.infeasible import ELASTIC_LIMIT, INDEX
from metafem.inversion.result import misfit_text
from metafem.models import Model
from metafem.models.curve import ModelError
from metafem.notes import Level, Note
from metafem.prediction import Onset

# A label, a value and a unit.
Row = tuple[str, str, str]

# Labels and printed units of the parameters that inversions report, and factors to the printed units.
PARAMETERS = {
    "scale": ("scale λ of the height density", "µm"),
    "weight": ("weight u of the upper branch", ""),
    "crossover_height": ("crossover height above the base", "µm"),
    "intercept": ("intercept α of the asymptote", "mm²"),
    "foot_load": ("rescaled load at which the glass reaches the lowest asperity", "mm²"),
    "counts": ("numbers of asperities", ""),
    "levels": ("levels above the base", "µm"),
    "prefactor": ("prefactor C of the power law", "mm^(2-2β)"),
    "intercepts": ("intercepts of the branches", "mm²"),
    "adjustment_heights": ("adjustment heights above the base", "µm"),
    "load_range": ("rescaled loads over which friction is proportional to load", "mm²"),
    "span": ("depth of the lowest summit below the tallest", "µm"),
    "used_radii": ("radii in use", "µm"),
    "radius_counts": ("numbers of asperities with them", ""),
    "tool_counts": ("numbers of asperities of each tool", ""),
    "used_exponents": ("exponents of the caps in use", ""),
    "exponent_counts": ("numbers of asperities with them", ""),
    "tilt_before": ("rms change of A0 by the tilt, heights at random sites", "%"),
    "tilt_after": ("the same after exchanges of heights", "%"),
    "step_levels": ("levels after quantisation, above the base", "µm"),
    "step_counts": ("numbers of asperities on these levels", ""),
    "step_loss": ("change of the misfit by quantisation", "%"),
}
FACTORS = {"µm": MICROMETRES, "%": 100.0}

# Significant digits of a parameter, and of a change of the misfit or of A0.
DIGITS, CHANGE_DIGITS = 6, 3

# Areas below this fraction of the largest area are printed as 0; so are heights below this fraction of the
# largest height, and percentages below this fraction of 100 %.
ZERO = 1e-9

# Largest number of printed values of one parameter.
MOST_PRINTED = 24


def model_data(model: Model) -> dict[str, str]:
    """Return a model's name and its Python code, for JSON.

    Examples
    --------
    >>> from metafem import Independent
    >>> model_data(Independent())
    {'name': 'independent', 'python': 'Independent()'}
    """
    return {"name": model.name, "python": repr(model)}


def error_parts(error: ModelError) -> tuple[str, str]:
    """Return the estimated error of a model, and its source or why it is unknown, in words."""
    if math.isnan(error):
        return "unknown", f"because {error.source}"
    return percent(error), f"by {error.source}"


def error_words(error: ModelError) -> str:
    """Return the estimated error of a model in words.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> error_words(mf.equilibrium(surface, mf.Interacting(1), load=0.2).model_error)
    'estimated error of A0(P): 0.067 %, by order 3 on the half-space'
    """
    return f"estimated error of A0(P): {', '.join(error_parts(error))}"


def error_data(error: ModelError) -> dict[str, Any]:
    """Return the estimated error of a model for JSON; its value is None if it is unknown."""
    return {"value": None if math.isnan(error) else float(error), "source": error.source}


def misfit_words(design: Design) -> tuple[str, str]:
    """Return what the misfit of a design means, and the value of the misfit.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> misfit_words(mf.design(mf.OperatingPoints([0.01], [0.1]), template))
    ('misfit: largest difference from the target', 'below 1e-9')
    """
    return f"misfit: {design.misfit_meaning}", misfit_text(design.misfit)


def all_notes(design: Design, hardness: float | None = None) -> tuple[Note, ...]:
    """Return the notes of a design and of its plasticity index, warnings first.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        Hardness H of the softer material [MPa]; default: None, without the plasticity index.
    """
    found = [*design.notes]
    if hardness is not None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MetafemWarning)
            psi = plasticity_index(design.surface, hardness)
        numbers = (INDEX, psi, ELASTIC_LIMIT, ("hardness", "radius"))
        found += [Note(str(warning.message), Level.WARNING, *numbers) for warning in caught]
    return tuple(sorted(found, key=lambda note: not note.warns))


def parameter_rows(design: Design) -> list[Row]:
    """Return the labels, values and units of the parameters that the inversion determined."""
    rows = []
    heights = MICROMETRES * float(np.abs(design.surface.height).max())
    scales = {"%": 100.0, "mm²": float(design.law.rescaled_friction[-1]), "µm": heights}
    for name, value in design.parameters.items():
        words, unit = PARAMETERS[name]
        numbers = np.atleast_1d(np.asarray(value) * FACTORS.get(unit, 1))
        zero = ZERO * scales.get(unit, 0.0)
        digits = CHANGE_DIGITS if unit == "%" else DIGITS
        text = ", ".join(
            f"{0.0 if abs(number) < zero else number:.{digits}g}"
            for number in numbers[:MOST_PRINTED].tolist()
        )
        more = len(numbers) - MOST_PRINTED
        rows.append((words, f"{text}, and {more} more in design.json" if more > 0 else text, unit))
    return rows


def fit_table(design: Design) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return headings and rows on the fitted slopes, in rescaled values or in the newtons of the target.

    The target intercept is that of the target line, or that of the asymptote of a height density if it is
    known. If the target is given by rescaled slopes and the surface has a Friction, two more columns contain
    friction coefficients and intercepts in newtons.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> fit_table(mf.design(mf.LinearLaw(6.87), template))[1][0][:2]
    ('0.1203 – 0.4814', '6.87')
    """
    wording, modulus, stress = design.target.wording, 1.0, 1.0
    load, area = "rescaled loads [mm²]", "mm²"
    both = design.surface.friction is not None
    if wording.composite_modulus and wording.shear_stress:  # the target was given in newtons
        modulus, stress = wording.composite_modulus, wording.shear_stress
        load, area, both = "loads [N]", "N", False
    rows, slope = [], stress / modulus
    for branch, fit in design.fits:
        low, high = fit.slope_interval
        row = {
            load: " – ".join(f"{modulus * end:.4g}" for end in fit.load_range),
            f"target {wording.name()}": f"{slope * branch.slope:.4g}",
            "fitted (68 %)": f"{slope * fit.slope:.4g} ± {0.5 * slope * (high - low):.1g}",
            "deviation": percent(fit.slope / branch.slope - 1.0, "+.2f"),
            f"fitted intercept [{area}]": f"{stress * fit.intercept:.4f}",
            f"target intercept [{area}]": (
                "–" if branch.intercept is None else f"{stress * branch.intercept:.4f}"
            ),
        }
        if both:
            row["friction coefficient dF/dP"] = f"{fit.friction_coefficient:.4g}"
            row["intercept [N]"] = f"{fit.intercept_force:.4f}"
        rows.append(row)
    return tuple(rows[0] if rows else ()), [tuple(row.values()) for row in rows]


def onset_words(sliding: Onset) -> str:
    """Return the result of an onset of sliding in one sentence."""
    first, last = (three_digits(MICROMETRES * sliding.displacement[i]) for i in (0, -1))
    return (
        f"At a load of {three_digits(sliding.state.load)} N, contacts slide from a tangential displacement "
        f"of {first} µm on, and all from {last} µm on, at a friction force of "
        f"{three_digits(float(sliding.friction_force[-1]))} N; before, the tangential stiffness is "
        f"{three_digits(sliding.stiffness)} N/mm"
    )
