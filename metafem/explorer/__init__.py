"""The explorer: a page in the browser where the user draws a target law and sees the designed surface.

The state of the page is the text of a specification. Each design is computed from that text only, as
``metafem design`` does, so both designs agree to the last bit. The browser stores the state and its history.
"""

from metafem.explorer.start import explore

__all__ = ["explore"]
