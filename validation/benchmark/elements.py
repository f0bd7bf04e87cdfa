"""Wall time of the finite-element contacts and checks; `python -m validation.benchmark.elements`."""

from __future__ import annotations

import time
from collections.abc import Callable

from metafem import fe
from metafem.fe.checks import BLOCK_RADIUS, RADIUS, THICKNESS

# Seconds that are wanted on two free cores.
ROWS: tuple[tuple[str, float, Callable[[], object]], ...] = (
    ("Hertz to 1e-8, nu = 0.5", 3.0, lambda: fe.press(0.2, RADIUS, 0.5)),
    ("Hertz to 1e-8, nu = 0.3", 3.0, lambda: fe.press(0.2, RADIUS, 0.3)),
    (
        "cap on the block",
        3.0,
        lambda: fe.press(0.2, RADIUS, height=0.2, thickness=THICKNESS, block_radius=BLOCK_RADIUS),
    ),
    (
        "all checks",
        60.0,
        lambda: [check() for check in (fe.hertz_check, fe.cap_check, fe.layer_check, fe.cell_check)],
    ),
)


def main() -> None:
    """Print what is wanted and what is measured."""
    for name, wanted, call in ROWS:
        start = time.perf_counter()
        call()
        print(f"{name:30s} wanted {wanted:6.1f} s   measured {time.perf_counter() - start:6.2f} s")


if __name__ == "__main__":
    main()
