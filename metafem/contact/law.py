"""What every law of a single contact offers."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from metafem._validate import FloatArray


@runtime_checkable
class Contact(Protocol):
    """Law of one contact, in rescaled load P/E*; open where the indentation is negative.

    All methods are vectorised over the indentation d [mm] and the summit radius R [mm].
    """

    def load(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Rescaled load P/E* [mm^2]."""
        ...

    def area(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Real contact area [mm^2]."""
        ...

    def stiffness(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Derivative of the rescaled load by the indentation [mm]."""
        ...
