"""The figures, the notes and the warnings as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from metafem.explorer.certainty.figures import Standing
from metafem.notes import Note, counted

# Sign and class of the chip of each standing.
CHIPS = {
    Standing.GOOD: ("✓", "good"),
    Standing.WARNING: ("▲", "warn"),
    Standing.REMARK: ("●", ""),
    Standing.UNKNOWN: ("?", ""),
}
HEAD = '<thead class="unseen"><tr><th>state</th><th>figure</th><th>value and bound</th></tr></thead>'


def figure_table(data: Mapping[str, Any]) -> str:
    """Return the table of the figures, with the words above and below it."""
    above = f'<p class="warn">{escape(data["words"])}</p>' if data["words"] else ""
    below = f'<p class="quiet small">Band of the law: {escape(data["band"])}.</p>' if data["band"] else ""
    rows = "".join(map(_row, data["rows"]))
    return f'{above}<table class="figure-table">{HEAD}<tbody>{rows}</tbody></table>{below}'


def _row(row: Mapping[str, Any]) -> str:
    standing = row["standing"]
    sentence = row["sentence"].replace(" %", "\u00a0%")  # a number and its unit stay on one line
    return (
        f'<tr data-standing="{standing}"><td>{chip(standing, standing)}</td>'
        f'<th scope="row">{escape(row["name"])}{_small(sentence)}</th>'
        f'<td class="number">{escape(row["value"])}{_small(row["bound"])}</td></tr>'
    )


def _small(words: str) -> str:
    return f'<span class="quiet small">{escape(words)}</span>'


def chip(standing: Standing, words: str) -> str:
    """Return words in a chip with the sign of a standing."""
    sign, tint = CHIPS[standing]
    return f'<span class="chip {tint}"><span aria-hidden="true">{sign}</span>{words}</span>'


def note_list(notes: Sequence[Note]) -> tuple[str, str]:
    """Return how many warnings and other notes there are, and their paragraphs."""
    kinds = {True: ("warn", "Warning"), False: ("note", "Note")}
    named = [(*kinds[note.warns], escape(str(note))) for note in notes]
    texts = (f'<p class="{kind}"><strong>{name}:</strong> {text}</p>' for kind, name, text in named)
    return f"{counted(notes)} on the design", "".join(texts)
