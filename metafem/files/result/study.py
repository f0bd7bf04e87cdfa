"""Studies in a result folder, which are NetCDF files, and their conversion to plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from metafem.errors import refuse_if
from metafem.files.atomic import refuse_existing, write_file
from metafem.files.reading import damaged, file_label
from metafem.files.result.folder import read_result
from metafem.files.result.names import STUDIES
from metafem.notes import from_lines
from metafem.progress import doing

if TYPE_CHECKING:
    from xarray import Dataset


def study_path(folder: str | Path, name: str, force: bool) -> Path:
    """Return the path of a study in a result folder; raise InvalidInput if `write_study` would refuse it."""
    read_result(folder)  # raises an error if this is not a result folder
    path = Path(folder) / f"{name}.nc"
    refuse_existing(path, force)
    return path


def write_study(study: Dataset, path: Path, *, force: bool = False) -> None:
    """Write a study as NetCDF 4 with h5netcdf; an existing file is refused unless `force` is true."""
    write_file(path, lambda fresh: study.to_netcdf(fresh, engine="h5netcdf"), force=force)


@doing("reading the studies")
def stored_studies(folder: str | Path) -> dict[str, Dataset]:
    """Return the studies in a result folder by name; raise InvalidInput for a damaged file."""
    import xarray as xr

    found = {}
    for name in STUDIES:
        path = Path(folder) / f"{name}.nc"
        if not path.exists():
            continue
        with damaged(path), xr.open_dataset(path, engine="h5netcdf") as stored:
            found[name] = stored.load()
        other = found[name].attrs.get("study") != name
        refuse_if(other, f"{file_label(path)} is not a study {name!r} of metafem")
    return found


def study_data(study: Dataset) -> dict[str, Any]:
    """Return a study as dicts, lists, numbers and texts; nan and infinite numbers become None."""
    arrays = {
        str(name): {
            "dims": list(array.dims),
            "units": array.attrs.get("units", ""),
            "values": plain_data(array.values),
        }
        for name, array in study.variables.items()
    }
    notes = [note.to_json() for note in from_lines(str(study.attrs["notes"]))]
    return {**study.attrs, "notes": notes, "data": arrays}


def plain_data(value: Any) -> Any:
    """Return a value in which arrays become lists, and nan and infinite numbers become None."""
    if isinstance(value, Mapping):
        return {name: plain_data(member) for name, member in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain_data(member) for member in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
