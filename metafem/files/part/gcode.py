"""The holes of a mould as a drilling program for a ball-end mill (ISO 6983)."""

from __future__ import annotations

# Defaults of the feed of the plunge [mm/min], the speed of the spindle [1/min], the dwell at the bottom of a
# hole [s] and the height of the tool above the mould between two holes [mm], for small carbide ball-end mills
# in aluminium or brass.
FEED, SPINDLE, DWELL, SAFE = 20.0, 8000.0, 0.5, 5.0
