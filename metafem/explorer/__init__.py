"""The explorer: a page in the browser where the user draws a target law and sees the designed surface.

The state of the page is the table of a specification, which edits change, and of which its text is written.
Each design is computed from it only, as ``metafem design`` does, so both designs agree to the last bit. The
browser stores the state and its history.
"""

from metafem.explorer.start import explore

__all__ = ["explore"]
