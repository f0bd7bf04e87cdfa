"""The images of a sample: measurement, tracking of contacts, and printed tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.calibration.contact_table import listed
from metafem.cli.terminal import notes_data
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.calibration import ContactAreas, DesignSites, TrackedContacts
    from metafem.files import Images, Shot

# Difference of a matched lattice's scale from 1 above which a warning is given: areas are then wrong by 2 %.
SCALE = 0.01


# Column titles of the printed table. Columns in OPTIONAL are left out if they are empty.
TITLES = {
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
OPTIONAL = ("test", "load_N", "friction_force_N", "sheared_area_mm2", "sheared_area_error_mm2")


@dataclass(frozen=True)
class Series:
    """Measured images, with their forces and their contacts before and under shear."""

    series: Sequence[Shot]
    areas: Sequence[ContactAreas]
    sheared: Sequence[ContactAreas | None]
    tracked: TrackedContacts
    pixel: float
    notes: tuple[Note, ...]

    @property
    def failed(self) -> list[str]:
        """Names of the images that could not be measured."""
        files = [image for shot in self.series for image in (shot.image, shot.sheared)]
        found = [areas for pair in zip(self.areas, self.sheared, strict=True) for areas in pair]
        pairs = zip(files, found, strict=True)
        return [image.name for image, areas in pairs if image and areas and areas.failed]

    def lines(self) -> tuple[list[str], list[list[str]]]:
        """Return the column titles and the rows of the printed table."""
        rows = self.rows()
        names = [name for name in TITLES if name not in OPTIONAL or any(row[name] for row in rows)]
        return [TITLES[name] for name in names], [[_text(name, row[name]) for name in names] for row in rows]

    def rows(self) -> list[dict[str, Any]]:
        """Return forces, numbers of contacts and areas of each image, for JSON and the printed table.

        An area is the sum over the contacts that could be measured.
        """
        table = self.tracked.table
        return [
            {
                "image": name,
                "test": table.test[i],
                "load_N": _known(table.load[i]),
                "friction_force_N": _known(table.friction_force[i]),
                **_numbers(self.areas[i], table.area[i], table.area_error[i]),
                **{
                    f"sheared_{key}": value
                    for key, value in _numbers(
                        self.sheared[i], table.sheared_area[i], table.sheared_area_error[i]
                    ).items()
                    if key.startswith("area")
                },
            }
            for i, name in enumerate(table.image)
        ]

    def sentences(self) -> list[str]:
        """Return a sentence that states how the contacts were numbered or matched to sites."""
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
        """Return the results for JSON; `files` are the files that were written."""
        table, match = self.tracked.table, self.tracked.match
        matched = match and {
            "image": table.image[self.tracked.reference],
            "viewed_from": "block" if match.mirrored else "glass",
            "rotation_deg": math.degrees(match.rotation),
            "scale": match.scale,
            "residual_mm": match.residual,
            "ambiguous": match.ambiguous,
        }
        return {
            "files": [str(path) for path in files],
            "pixel_size_mm": self.pixel,
            "images": self.rows(),
            "match": matched,
            "site": table.site.tolist(),
            "area_mm2": [[_known(value) for value in row] for row in table.area.tolist()],
            "failed": self.failed,
            "remarks": list(self.tracked.remarks),
            "notes": notes_data(self.notes),
        }


def measured_series(
    series: Sequence[Shot], pixel: float, notes: Sequence[Note], rotation: float, options: dict[str, Any]
) -> Series:
    """Return the measured images with tracked contacts; images before and under shear share one threshold."""
    before = [shot.image for shot in series]
    after = [i for i, shot in enumerate(series) if shot.sheared is not None]
    load = np.array([shot.load for shot in series])
    files = [*before, *(shot.sheared for shot in series if shot.sheared is not None)]
    images = mf.files.Images(files)
    found = _measured(images, pixel, np.concatenate([load, load[after]]), options["bright_contacts"])
    areas, sheared = found[: len(before)], dict(zip(after, found[len(before) :], strict=True))
    sites = _sites(options, rotation)
    others = [sheared.get(i) for i in range(len(before))]
    with doing("following the contacts"):
        tracked = mf.calibration.track_contacts(
            areas,
            [file.name for file in before],
            test=[shot.test for shot in series],
            load=load,
            friction_force=[shot.friction_force for shot in series],
            sheared=others,
            sites=sites,
        )
    more = [*notes, *_notes(images, areas, tracked, pixel)]
    # warnings on the match come first, because the sentence on the match is printed before the notes
    first = [note for note in tracked.notes if note.warns]
    last = [note for note in tracked.notes if not note.warns]
    return Series(series, areas, others, tracked, pixel, (*first, *more, *last))


def _measured(images: Images, pixel: float, load: Any, bright: bool) -> list[ContactAreas]:
    """Return the contacts of each image; their notes name other images by their files."""
    names = Names({f"images[{i}]": file.name for i, file in enumerate(images.files)})
    known = np.isfinite(load)
    # the image at the largest load determines the threshold: images without a load get the smallest load, and
    # without any loads `stack_areas` uses the last image
    order = np.where(known, load, load[known].min() - 1.0) if known.any() else None
    try:
        found = mf.calibration.stack_areas(images, pixel, loads=order, bright_contacts=bright)
    except InvalidInput as error:
        hint = "; --bright-contacts is given: are the contacts brighter than the ground?" if bright else ""
        error.names = names
        raise InvalidInput(f"{error}{hint}") from None
    own = [names.under(Names({f"images[{i}]": "this image"})) for i in range(len(found))]
    return [
        replace(areas, notes=tuple(note.named(own[i]) for note in areas.notes))
        for i, areas in enumerate(found)
    ]


def _notes(
    images: Images, areas: Sequence[ContactAreas], tracked: TrackedContacts, pixel: float
) -> Iterator[Note]:
    """Yield the notes that concern all images."""
    if images.coloured:
        names = listed(list(images.coloured))
        yield information(f"in colour, the luminance of ITU-R BT.709 is measured: {names}")
    smallest = max(one.smallest_area for one in areas if not one.failed)
    if smallest > 0.0:
        yield information(
            f"contacts of less than {smallest:.2g} mm² are not found and count as open; ± is the standard "
            "deviation of the sum over the closed ones"
        )
    match = tracked.match
    if match is not None and abs(match.scale - 1.0) > SCALE:
        yield Note(
            f"the sites are {match.scale:.4f} times as far apart as in the design: with pixels of "
            f"{1e3 * pixel / match.scale:.4g} um instead of {1e3 * pixel:.4g} um they would agree, and areas "
            f"would be {100.0 * (match.scale**-2 - 1.0):+.2g} % different"
        )


def _sites(options: dict[str, Any], rotation: float) -> DesignSites | None:
    """Return the sites of a design, from its table of heights."""
    source = options["sites"]
    if source is None:
        return None
    refuse_if(not source.exists(), f"--sites {source}: no such file or folder")
    position, number = mf.files.read_sites(source / "heights.csv" if source.is_dir() else source)
    return mf.calibration.DesignSites(position, number, options["viewed_from"], rotation)


def _known(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _numbers(areas: ContactAreas | None, area: Any, error: Any) -> dict[str, Any]:
    """Return the numbers of contacts, and the sum of their areas with its error; None if not measured.

    The errors of closed contacts are independent, so that their squares are added.
    """
    measured = areas is not None and not areas.failed
    values = {
        "contacts": int(np.count_nonzero(area > 0.0)),
        "open": int(np.count_nonzero(area == 0.0)),
        "not_measured": int(np.count_nonzero(np.isnan(area))),
        "area_mm2": float(np.nansum(area)),
        "area_error_mm2": float(np.sqrt(np.square(error[area > 0.0]).sum())),
    }
    return {name: value if measured else None for name, value in values.items()}


def _text(name: str, value: Any) -> str:
    """Return the text of an entry in the printed table."""
    if value is None:
        return ""
    digits = ".2g" if "error" in name else ".4f" if "area" in name else ".5g"
    return f"{value:{digits}}" if isinstance(value, float) else str(value)
