"""What a design of many places costs, said before it is begun."""

from __future__ import annotations

from metafem.errors import InvalidInput
from metafem.files.reading import RECORD
from metafem.models._resources import require_memory
from metafem.progress import fact

# Of each place under the independent model, measured on lattices of 10^5 and 10^6 places: bytes of the record
# where all digits are needed, memory at the most [bytes], and time of design, report and files [s].
RECORDED, MEMORY, TIME = 250, 1_800, 4.5e-5

# Time from which on the cost is worth a line [s].
WORTH_A_LINE = 5.0


def refuse_too_many(places: int) -> None:
    """Refuse a lattice whose result does not fit into a file or the memory; reads on after a key."""
    most = RECORD // RECORDED
    if places > most:
        raise InvalidInput(
            f"has {places:,} places; at most {most:,} fit into a result that can be read again"
        )
    try:
        require_memory(MEMORY * places, f"has {places:,} places: their design")
    except InvalidInput as error:
        raise InvalidInput(f"{error}; ask for fewer") from None


def tell_cost(places: int) -> None:
    """Say what many places cost before they are designed."""
    if TIME * places >= WORTH_A_LINE:
        memory = f"{MEMORY * places / 2**30:.1f} GiB of memory"
        fact(
            f"{places:,} places: about {TIME * places:.0f} s and {memory} for the design and its files under "
            "the independent model; other models and the part take longer"
        )
