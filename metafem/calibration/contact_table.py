"""Contact areas in a series of images with the measured forces, and the points for fits and laws.

A table of contacts is a DataFrame with one row for each image and contact, image by image: ``image`` and
``test`` (names), ``load`` and ``friction_force`` [N], ``contact`` (its number, from 1), ``site`` (in the
design; empty if the contacts were not matched), ``x`` and ``y`` [mm], ``area`` and ``sheared_area`` with
``area_error`` and ``sheared_area_error`` [mm^2], the last two at the peak of the friction force. What was not
measured is nan. An open contact has the area 0, and as its error the smallest area that can be detected.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import printable
from metafem.notes import Note, information

if TYPE_CHECKING:
    from pandas import DataFrame

# Largest number of images or contacts that a sentence names.
NAMED = 5

AREAS = ("area", "area_error", "sheared_area", "sheared_area_error")
COLUMNS = ("image", "test", "load", "friction_force", "contact", "site", "x", "y", *AREAS)


def contact_table(forces: DataFrame, position: Any, site: Any, *areas: Any) -> DataFrame:
    """Return the table of n contacts in k images.

    Parameters
    ----------
    forces : DataFrame, (k,)
        Columns image, test, load and friction_force.
    position : array_like, (n, 2)
        Positions of the contacts [mm].
    site : array_like of int, (n,), or None
        Sites of the contacts; None if they were not matched.
    *areas : array_like, (k, n)
        Areas, their errors, and the same under shear [mm^2]; default: nan.

    Returns
    -------
    DataFrame, (k n,)

    Examples
    --------
    >>> import pandas as pd
    >>> forces = pd.DataFrame({"image": ["1.tif"], "test": "", "load": 0.05, "friction_force": np.nan})
    >>> table = contact_table(forces, [[0.0, 0.0], [1.5, 0.0]], [7, 3], [[0.1, 0.0]], [[1e-3, 1e-3]])
    >>> table[["image", "contact", "site", "x", "area"]].values.tolist()
    [['1.tif', 1, 7, 0.0, 0.1], ['1.tif', 2, 3, 1.5, 0.0]]
    """
    import pandas as pd

    k, n = len(forces), len(position)
    table = forces[[*COLUMNS[:4]]].loc[forces.index.repeat(n)].reset_index(drop=True)
    table["contact"] = np.tile(np.arange(1, n + 1), k)
    table["site"] = pd.array([pd.NA] * n * k if site is None else np.tile(site, k), dtype="Int64")
    table["x"], table["y"] = np.tile(np.reshape(position, (n, 2)), (k, 1)).T
    for i, name in enumerate(AREAS):
        table[name] = np.ravel(areas[i]) if i < len(areas) else np.nan
    return table


def by_image(table: DataFrame) -> tuple[DataFrame, dict[str, FloatArray]]:
    """Return the names and forces of the k images, and the areas by their column, (k, n)."""
    count = int(table["contact"].nunique())
    areas = {name: table[name].to_numpy(dtype=float).reshape(-1, count) for name in AREAS}
    return table.iloc[::count, :4].reset_index(drop=True), areas


def listed(names: Iterable[str]) -> str:
    """Return a list of names as part of a sentence, shortened if it is long.

    Examples
    --------
    >>> listed(["1.tif", "2.tif", "3.tif", "4.tif", "5.tif", "6.tif", "7.tif"])
    '1.tif, 2.tif, 3.tif, 4.tif, 5.tif and 2 more'
    """
    every = list(names)
    more = f" and {len(every) - NAMED} more" if len(every) > NAMED else ""
    return ", ".join(printable(name, 60) for name in every[:NAMED]) + more


def pressed_points(table: DataFrame) -> tuple[DataFrame, list[Note]]:
    """Return the points of a compression fit, one for each used image, and notes on omitted images.

    The columns are load [N], area_1, area_2 ... [mm^2] and test. The measured load is the sum over all
    contacts. If the area of one contact is unknown, so is its share of the load, and the image does not
    determine E*. A fit to the sum of the other areas would bias E*.
    """
    images, areas = by_image(table)
    area, loaded = areas["area"], images["load"].notna().to_numpy()
    used = loaded & np.isfinite(area).all(axis=1) & (area > 0.0).any(axis=1)
    left = loaded & ~used
    what = "contact" if table["site"].isna().any() else "site"
    unknown = table[what].to_numpy()[: area.shape[1]][np.isnan(area[left]).any(axis=0)]
    missing = listed(f"{what} {number}" for number in unknown) or "all contacts"
    words = f"E* is fitted without {listed(images['image'][left])}: the area of {missing} is 0 or unknown"
    notes = [Note(f"{words}, and the load is that of all contacts")] * bool(left.any())
    named = {f"area_{i + 1}": each for i, each in enumerate(area.T)}
    return images[["load", "test"]].assign(**named)[used], notes


def sheared_points(table: DataFrame) -> tuple[DataFrame, list[Note]]:
    """Return the points of a shear fit, and notes on missing quantities.

    The columns are area_before, area_sheared [mm^2], friction_force [N], nan if not measured, and test.

    An image gives one point if all its contacts were measured before and after shear. Otherwise the contacts
    that are visible before and after shear give a point that determines B; a contact that is too small to be
    detected in one of the two images would bias the ratio of the sums. The sheared areas of all contacts, if
    they were measured, give another one with the friction force, which determines sigma.
    """
    import pandas as pd

    images, areas = by_image(table)
    before, after, force = areas["area"], areas["sheared_area"], images["friction_force"].to_numpy()
    both = np.isfinite(before) & np.isfinite(after)
    seen = both & (before > 0.0) & (after > 0.0)
    hides = (both & ((before > 0.0) != (after > 0.0))).any(axis=1)
    whole, total = both.all(axis=1) & ~hides, np.where(hides, np.nan, after.sum(axis=1))
    some, alone = seen.any(axis=1), ~whole & (total > 0.0) & np.isfinite(force)
    sums = [np.where(seen, area, 0.0).sum(axis=1) for area in (before, after)]
    ratio, strength = (
        images[["test"]].assign(area_before=before, area_sheared=after, friction_force=force)
        for before, after, force in ((*sums, np.where(whole, force, np.nan)), (np.nan, total, force))
    )
    unused = np.isfinite(force) & np.isfinite(after).any(axis=1) & ~whole & ~alone
    words = f"sigma is fitted without {listed(images['image'][unused])}, of which a contact is not measured"
    return pd.concat([ratio[some], strength[alone]]), [information(f"{words} before or after shear")] * bool(
        unused.any()
    )
