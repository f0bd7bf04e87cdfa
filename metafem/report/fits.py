"""Table of the target branches and the fitted branches, in the units of the target."""

from __future__ import annotations

from metafem._values import percent
from metafem.inversion import Design
from metafem.inversion.problem import Branch
from metafem.prediction import BranchFit


def fit_table(design: Design) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return headings and rows, in rescaled values or in friction coefficients and newtons.

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
    wording = design.target.wording
    forces = wording.per_slope is not None
    load, area = ("loads [N]", "N") if forces else ("rescaled loads [mm²]", "mm²")
    columns = [load, f"target {wording.name()}", "fitted (68 %)", "deviation"]
    columns += [f"fitted intercept [{area}]", f"target intercept [{area}]"]
    both = design.surface.friction is not None and not forces
    if both:
        columns += ["friction coefficient dF/dP", "intercept [N]"]
    return tuple(columns), [_row(design, branch, fit, both) for branch, fit in design.fits]


def _row(design: Design, branch: Branch, fit: BranchFit, both: bool) -> tuple[str, ...]:
    wording = design.target.wording
    modulus = wording.composite_modulus if wording.per_slope is not None else None
    stress = wording.shear_stress if wording.per_slope is not None else None
    low, high = ((modulus or 1.0) * end for end in fit.load_range)
    half = 0.5 * (fit.slope_interval[1] - fit.slope_interval[0])
    row = [
        f"{low:.4g} – {high:.4g}",
        f"{wording.coefficient(branch.slope):.4g}",
        f"{wording.coefficient(fit.slope):.4g} ± {wording.coefficient(half):.1g}",
        percent(fit.slope / branch.slope - 1.0, "+.2f"),
        f"{(stress or 1.0) * fit.intercept:.4f}",
        "–" if branch.intercept is None else f"{(stress or 1.0) * branch.intercept:.4f}",
    ]
    if both:
        row += [f"{fit.friction_coefficient:.4g}", f"{fit.intercept_force:.4f}"]
    return tuple(row)
