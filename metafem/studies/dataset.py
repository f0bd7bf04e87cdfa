"""What a study returns: a dataset with units, names and provenance, and the table that summarises it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from metafem.notes import Note, from_lines, to_lines
from metafem.prediction.base_law import QUANTITIES, described

if TYPE_CHECKING:
    import xarray as xr

# Probabilities of the quantiles in the results.
QUANTILES = [0.05, 0.5, 0.95]

# Units and long names of the variables and coordinates.
STUDIED: Mapping[str, tuple[str, str]] = QUANTITIES | {
    "slope": ("1", "slope of the law"),
    "area_change": ("1", "change of the real contact area from independent asperities"),
    "assignment_rms": ("1", "root mean square change of the area of a random assignment"),
    "sinking": ("mm", "decrease of the separation by interaction"),
    "deviation": ("mm2", "rescaled friction less the predicted real contact area"),
    "stress": ("MPa", "friction force over rescaled friction, 0 for a law of areas"),
    "predicted": ("mm2", "rescaled friction of the design"),
    "chi_square": ("1", "sum of the squares of the normalised deviations"),
    "freedom": ("1", "degrees of freedom"),
    "failed": ("1", "number of draws without a solution"),
    "draws": ("1", "number of draws with a solution"),
    "misfit": ("1", "relative deviation from the target"),
    "height_sd": ("mm", "standard deviation of the heights"),
    "angle": ("rad", "largest tilt"),
    "quantile": ("1", "probability below the quantile"),
}

# Attributes of every dataset: a study of several models has no model, and one without draws no seed.
PROVENANCE: Mapping[str, Any] = {"model": "", "load_range": [], "seed": "", "draws": 0}

# Variables by name, each with its dimensions and values.
Variables = dict[str, tuple[tuple[str, ...], Any]]


def dataset(
    study: str,
    variables: Variables,
    coordinates: Mapping[str, Any],
    notes: Iterable[Note],
    **provenance: Any,
) -> xr.Dataset:
    """Return the dataset of a study, with `PROVENANCE` as far as it is known."""
    import xarray as xr

    attributes = {"study": study, "notes": to_lines(notes), **PROVENANCE, **provenance}
    found = xr.Dataset(variables, coordinates, attributes)
    for name, variable in found.variables.items():
        variable.attrs.update(described(str(name), STUDIED))
    return found


@dataclass(frozen=True)
class Summary:
    """The summary of a study: a table of texts, notes and a sentence.

    Attributes
    ----------
    title : str
    columns : tuple of str
        Headings.
    rows : tuple of tuple of str
    notes : tuple of Note
    answer : str
        What the study says about the part, in one sentence; empty for comparisons between models.

    Examples
    --------
    >>> Summary("Change of A0", ("model", "rms [%]"), (("layer", "0.21"),), ()).rows[0]
    ('layer', '0.21')
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[Note, ...]
    answer: str = ""

    @classmethod
    def of(cls, study: xr.Dataset, title: str, columns: Mapping[str, Any], answer: str = "") -> Summary:
        """Return the summary of a study from the columns of its table by their headings."""
        rows = tuple(zip(*(map(str, column) for column in columns.values()), strict=True))
        return cls(title, tuple(columns), rows, from_lines(str(study.attrs["notes"])), answer)


def texts(form: str, values: Iterable[float]) -> list[str]:
    """Return numbers as texts in the same format.

    Examples
    --------
    >>> texts("+.1f", [1.0, -0.26])
    ['+1.0', '-0.3']
    """
    return [f"{value:{form}}" for value in values]
