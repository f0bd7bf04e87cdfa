"""Time and memory of a design of many sites, reported before it begins."""

from __future__ import annotations

from metafem.errors import InvalidInput, refuse_if
from metafem.files.reading import RECORD
from metafem.models._resources import require_memory
from metafem.progress import message

# Per site under the independent model, measured on lattices of 10^5 and 10^6 sites: size of the record with
# all digits [bytes], peak memory [bytes], and time of design, report and files [s].
RECORDED, MEMORY, TIME = 250, 1_800, 4.5e-5

# Shortest time that is reported [s].
WORTH_A_LINE = 5.0


def refuse_too_many(rows: int, columns: int) -> None:
    """Refuse a lattice whose result does not fit into a file or the memory."""
    places, most = max(rows, 0) * max(columns, 0), RECORD // RECORDED
    shape = f"[{rows}, {columns}]"
    must = f"has {places:,} sites; at most {most:,} are allowed, so that the result can be read"
    refuse_if(places > most, must, key="shape", value=shape)
    try:
        require_memory(MEMORY * places, f"has {places:,} sites: their design")
    except InvalidInput as error:
        raise InvalidInput(f"{error}; use fewer sites", key="shape", value=shape) from None


def tell_cost(places: int) -> None:
    """Report time and memory before many sites are designed."""
    if TIME * places >= WORTH_A_LINE:
        memory = f"{MEMORY * places / 2**30:.1f} GiB of memory"
        message(
            f"{places:,} sites: about {TIME * places:.0f} s and {memory} for the design and its files under "
            "the independent model; other models and the part take longer"
        )
