"""Numbers that the paper prints; only the validation compares with them."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

FOLDER = Path(__file__).parent
PAPER = "Aymard et al. 2024"
REFERENCE = f"{PAPER}: Science 383, 200-204, doi:10.1126/science.adk4234; SM: its Supplementary Materials"


@cache
def paper() -> dict[str, Any]:
    """Return the printed numbers."""
    return tomllib.loads((FOLDER / "paper.toml").read_text("utf-8"))


def table(name: str) -> dict[str, np.ndarray]:
    """Return the columns of a printed table."""
    rows = np.genfromtxt(FOLDER / f"{name}.csv", delimiter=",", names=True)
    return {column: rows[column] for column in rows.dtype.names}
