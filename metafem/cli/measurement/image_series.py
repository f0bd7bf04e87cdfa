"""The images of a sample: measurement, tracking of contacts, and printed tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.cli.terminal import loaded, notes_data
from metafem.errors import InvalidInput
from metafem.notes import Note, information
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.calibration import ContactAreas, TrackedContacts
    from metafem.files import ImageFile, Images, Shot

# Difference of the scale of a matched lattice from 1 that is reported: areas are then wrong by 2 %.
SCALE = 0.01


@dataclass(frozen=True)
class Series:
    """Images with their forces and contacts."""

    series: Sequence[Shot]
    areas: Sequence[ContactAreas]
    sheared: Sequence[ContactAreas | None]
    tracked: TrackedContacts
    pixel: float
    notes: tuple[Note, ...]

    @property
    def failed(self) -> list[str]:
        """Names of the images that could not be measured."""
        pairs: list[tuple[ImageFile | None, ContactAreas | None]] = []
        for shot, areas, other in zip(self.series, self.areas, self.sheared, strict=True):
            pairs += [(shot.image, areas), (shot.sheared, other)]
        return [image.name for image, areas in pairs if image and areas and areas.failed]

    def lines(self) -> tuple[list[str], list[tuple[str, ...]]]:
        """Return the headings and the lines of the printed table."""
        rows = self.rows()
        titles = {
            "image": "image",
            "test": "test",
            "load_N": "load [N]",
            "friction_force_N": "friction [N]",
            "contacts": "contacts",
            "open": "open",
            "not_measured": "not measured",
            "area_mm2": "area [mm²]",
            "area_error_mm2": "± [mm²]",
            "sheared_area_mm2": "sheared area [mm²]",
            "sheared_area_error_mm2": "± [mm²]",
        }
        optional = ("test", "load_N", "friction_force_N", "sheared_area_mm2", "sheared_area_error_mm2")
        kept = [name for name in titles if name not in optional or any(row[name] for row in rows)]
        return [titles[name] for name in kept], [
            tuple(_text(name, row[name]) for name in kept) for row in rows
        ]

    def rows(self) -> list[dict[str, Any]]:
        """Return the numbers of each image; areas are of the contacts that could be measured."""
        table = self.tracked.table
        rows = []
        for i, name in enumerate(table.image):
            failed = self.areas[i].failed
            sheared = self.sheared[i]
            rows.append(
                {
                    "image": name,
                    "test": table.test[i],
                    "load_N": _known(table.load[i]),
                    "friction_force_N": _known(table.friction_force[i]),
                    "contacts": None if failed else int(np.count_nonzero(table.area[i] > 0.0)),
                    "open": None if failed else int(np.count_nonzero(table.area[i] == 0.0)),
                    "not_measured": None if failed else int(np.count_nonzero(np.isnan(table.area[i]))),
                    "area_mm2": None if failed else float(np.nansum(table.area[i])),
                    "area_error_mm2": None if failed else _together(table.area_error[i], table.area[i]),
                    "sheared_area_mm2": None
                    if sheared is None or sheared.failed
                    else float(np.nansum(table.sheared_area[i])),
                    "sheared_area_error_mm2": None
                    if sheared is None or sheared.failed
                    else _together(table.sheared_area_error[i], table.sheared_area[i]),
                }
            )
        return rows

    def sentences(self) -> list[str]:
        """Return sentences on the positions of the contacts."""
        table, match = self.tracked.table, self.tracked.match
        name = table.image[self.tracked.reference]
        count = len(table.site)
        if match is None:
            return [f"{count} contacts, numbered from top to bottom of {name}"]
        side = "block, mirrored against heights.csv" if match.mirrored else "glass"
        return [
            f"{int((match.site >= 0).sum())} contacts of {name} matched to {count} sites, seen through the "
            f"{side}: rotation {math.degrees(match.rotation):.2f}°, scale {match.scale:.4f}, rms distance "
            f"{1e3 * match.residual:.3g} µm"
        ]

    def data(self, files: Sequence[Path]) -> dict[str, Any]:
        """Return the data for JSON."""
        match = self.tracked.match
        table = self.tracked.table
        return {
            "files": [str(path) for path in files],
            "pixel_size_mm": self.pixel,
            "images": self.rows(),
            "match": None
            if match is None
            else {
                "image": table.image[self.tracked.reference],
                "viewed_from": "block" if match.mirrored else "glass",
                "rotation_deg": math.degrees(match.rotation),
                "scale": match.scale,
                "residual_mm": match.residual,
                "ambiguous": match.ambiguous,
            },
            "site": table.site.tolist(),
            "area_mm2": [[_known(value) for value in row] for row in table.area.tolist()],
            "failed": self.failed,
            "remarks": list(table.remarks),
            "notes": notes_data(self.notes),
        }


def measured_series(
    series: Sequence[Shot],
    pixel: float,
    notes: Sequence[Note],
    rotation: float,
    options: dict[str, Any],
) -> Series:
    """Measure the images, with one threshold before and after shear, and track the contacts."""
    before = [shot.image for shot in series]
    after = [i for i, shot in enumerate(series) if shot.sheared is not None]
    files = [*before, *(shot.sheared for shot in series if shot.sheared is not None)]
    load = np.array([shot.load for shot in series])
    known = np.isfinite(load)
    # an image without a load does not have the largest load; without any loads the last image has it
    order = np.where(known, load, load[known].min() - 1.0) if known.any() else np.arange(float(len(load)))
    images = mf.files.Images(files)
    names = Names({f"images[{i}]": file.name for i, file in enumerate(files)})
    bright = options["bright_contacts"]
    try:
        found = mf.calibration.stack_areas(
            images, pixel, loads=[*order, *order[after]], bright_contacts=bright
        )
    except InvalidInput as error:
        hint = "; --bright-contacts is given: are the contacts brighter than the ground?" if bright else ""
        error.names = names
        raise InvalidInput(f"{error}{hint}") from None
    found = tuple(_named(one, names, i) for i, one in enumerate(found))
    areas = found[: len(before)]
    sheared: list[ContactAreas | None] = [None] * len(before)
    for i, one in zip(after, found[len(before) :], strict=True):
        sheared[i] = one
    sites, expected = _sites(options["sites"], load)
    seen = None
    if sites is not None:
        seen = mf.calibration.DesignSites(
            sites.position, sites.number, expected, options["viewed_from"], rotation
        )
    with doing("following the contacts"):
        tracked = mf.calibration.track_contacts(
            areas,
            [file.name for file in before],
            test=[shot.test for shot in series],
            load=load,
            friction_force=[shot.friction_force for shot in series],
            sheared=sheared,
            sites=seen,
        )
    more = [*notes, *_notes(images, areas, tracked, pixel)]
    if sites is not None and (expected is None or np.isnan(expected[tracked.reference]).any()):
        more.append(
            information(
                "positions alone do not show whether the viewing side and the quarter turn are right; areas "
                "do, with --sites DIR, the result folder of the design, and --forces"
            )
        )
    # warnings on the match follow the sentence on it
    of_match = sorted(tracked.notes, key=lambda note: not note.warns)
    first = [note for note in of_match if note.warns]
    return Series(series, areas, sheared, tracked, pixel, (*first, *more, *of_match[len(first) :]))


def _notes(
    images: Images,
    areas: Sequence[ContactAreas],
    tracked: TrackedContacts,
    pixel: float,
) -> list[Note]:
    """Return the notes on all images."""
    from metafem.calibration.contact_table import listed

    notes = []
    if images.coloured:
        notes.append(
            information(
                f"in colour, the luminance of ITU-R BT.709 is measured: {listed(list(images.coloured))}"
            )
        )
    smallest = max(one.smallest_area for one in areas if not one.failed)
    if smallest > 0.0:
        notes.append(
            information(
                f"contacts of less than {smallest:.2g} mm² are not found and count as open; ± is the "
                "standard deviation of the sum over the closed ones"
            )
        )
    match = tracked.match
    if match is not None and abs(match.scale - 1.0) > SCALE:
        notes.append(
            Note(
                f"the sites are {match.scale:.4f} times as far apart as in the design: with pixels of "
                f"{1e3 * pixel / match.scale:.4g} um instead of {1e3 * pixel:.4g} um they would agree, and "
                f"areas would be {100.0 * (match.scale**-2 - 1.0):+.2g} % different"
            )
        )
    return notes


def _named(areas: ContactAreas, files: Names, own: int) -> ContactAreas:
    """Return the contacts of an image, with notes that name other images by their files."""
    names = Names({f"images[{own}]": "this image"})
    return replace(areas, notes=tuple(note.named(files.under(names)) for note in areas.notes))


def _sites(source: Path | None, load: Any) -> tuple[mf.files.Sites | None, Any]:
    """Return the sites of a design and, for a result folder, the areas that its law predicts at the loads."""
    if source is None:
        return None, None

    if not source.is_dir():
        if not source.exists():
            raise InvalidInput(f"--sites {source}: no such file or folder")
        return mf.files.read_sites(source), None
    design = loaded(source)
    expected = np.full((len(load), design.surface.count), np.nan)
    with doing("predicting the areas"):
        for i, force in enumerate(load.tolist()):
            if force > 0.0:
                # independent contacts suffice: the areas are compared up to a common factor
                expected[i] = mf.equilibrium(design.surface, mf.Independent(), load=force).asperity_area
    return mf.files.Sites(design.surface.position, np.asarray(design.sites)), expected


def _known(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _together(error: Any, area: Any) -> float:
    """Return the standard deviation of the sum of the areas of closed contacts with independent errors."""
    return float(np.sqrt(np.square(error[area > 0.0]).sum()))


def _text(name: str, value: Any) -> str:
    """Return a cell of the printed table."""
    if value is None:
        return ""
    digits = ".2g" if "error" in name else ".4f" if "area" in name else ".5g"
    return f"{value:{digits}}" if isinstance(value, float) else str(value)
