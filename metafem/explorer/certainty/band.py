"""The tolerance band: the scatter of the laws of manufactured surfaces about the law of the design.

The band is the linear response, from the derivatives dA0/dh and the covariance of the height errors.
"""

from __future__ import annotations

from weakref import finalize

from metafem._validate import FloatArray
from metafem._values import MICROMETRES
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.inversion import Design
from metafem.prediction import Tolerances
from metafem.prediction.tolerances import scatter

# A band, or a further law beside it, is computed at every n-th load of the law: at 34 of 100 loads. Straight
# lines are drawn between them.
EVERY = 3

# Largest numbers of independent and of coupled asperities for a band by linear response. Coupled asperities
# require the solution of n equations at each load, which takes 13 ms for 64 asperities and about a second for
# the largest number.
MOST_ALONE, MOST_COUPLED = 100_000, 400

# Rescaled load, and lowest and highest friction [mm^2].
Band = tuple[FloatArray, FloatArray, FloatArray]


# Bands of the designs on open pages, by the identity of the design, because hashing a design would compute
# all of its notes. Each is stored as long as its design exists.
_BANDS: dict[int, Band | None] = {}


def tolerances_of(answer: Answer) -> Tolerances | None:
    """Return the manufacturing errors that a specification states; None if it states none.

    These are those of the heights, ``limits.height_sd``.
    """
    deviation = None if answer.design is None else answer.design.limits.height_sd
    return Tolerances(height_sd=deviation) if deviation else None


def tolerance_words(tolerances: Tolerances) -> str:
    """Return the manufacturing errors of the part in words.

    Examples
    --------
    >>> tolerance_words(Tolerances(height_sd=0.0009))
    'errors of the heights of 0.9 µm (SD)'
    """
    return f"errors of the heights of {MICROMETRES * tolerances.height_sd:.3g} µm (SD)"


def tolerance_band(answer: Answer) -> Band | None:
    """Return rescaled load, and A0 of manufactured surfaces one standard deviation below and above [mm^2].

    The result is None if the specification states no errors, the surface has too many asperities or the model
    has no solution.
    """
    design, tolerances = answer.design, tolerances_of(answer)
    if design is None or tolerances is None:
        return None
    if id(design) not in _BANDS:
        finalize(design, _BANDS.pop, id(design), None)
        _BANDS[id(design)] = _linear(design, tolerances)
    return _BANDS[id(design)]


def band_words(answer: Answer) -> str:
    """Return the description of the band of an answer; "" if the specification states no errors."""
    tolerances = tolerances_of(answer)
    return "" if tolerances is None else f"± 1 SD of made surfaces, with {tolerance_words(tolerances)}"


def _linear(design: Design, tolerances: Tolerances) -> Band | None:
    model, surface = design.law.model, design.surface
    if surface.count > (MOST_COUPLED if model.couples else MOST_ALONE):
        return None
    load = design.law.rescaled_load[::-EVERY][::-1]
    try:
        mean, sd = scatter(surface, model, load, tolerances.height_sd)
    except MetafemError:  # the model has no solution at these loads
        return None
    return load, mean - sd, mean + sd
