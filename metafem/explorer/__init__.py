"""The explorer: a page in the browser on which a target law is drawn and the surface follows.

The text of a specification is the state of the page. Each answer is computed from that text alone, as by
``metafem design``, so that both give the same design to the bit. The browser keeps the state and its history.
"""

from metafem.explorer.start import explore

__all__ = ["explore"]
