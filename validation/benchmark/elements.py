"""Times of single contacts by finite elements, and of their checks."""

from __future__ import annotations

from metafem import fe, studies
from metafem.studies.element_checks import BLOCK_RADIUS, RADIUS, THICKNESS
from validation.timing import Row, best


def rows() -> list[Row]:
    """Measure Hertz's contact on a half-space, a cap on its block, and all checks."""

    def cap() -> None:
        fe.press(0.2, RADIUS, height=0.2, thickness=THICKNESS, block_radius=BLOCK_RADIUS)

    def checks() -> None:
        for check in (studies.hertz_check, studies.cap_check, studies.layer_check, studies.cell_check):
            check()

    measured = [
        Row(f"Hertz to 1e-8, nu = {nu}", 15.0, best(lambda nu=nu: fe.press(0.2, RADIUS, nu), 3), "s")
        for nu in (0.3, 0.49, 0.5)
    ]
    measured.append(Row("cap on the block", 3.0, best(cap, 3), "s"))
    measured.append(Row("all checks together", 60.0, best(checks, 1), "s"))
    return measured
