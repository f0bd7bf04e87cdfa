"""The figures, the notes and the warnings as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from metafem.explorer.certainty.figures import Standing

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


def note_list(notes: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """Return how many warnings and other notes there are, and their paragraphs."""
    kinds = {True: ("warn", "Warning"), False: ("note", "Note")}
    named = [(*kinds[note["warns"]], escape(note["text"])) for note in notes]
    texts = (f'<p class="{kind}"><strong>{name}:</strong> {text}</p>' for kind, name, text in named)
    warnings = sum(note["warns"] for note in notes)
    counts = counted(warnings, "warning"), counted(len(notes) - warnings, "note")
    return f"{', '.join(filter(None, counts))} on the design", "".join(texts)


def counted(count: int, word: str) -> str:
    """Return a number of things in words; "" for none.

    Examples
    --------
    >>> counted(1, "note"), counted(2, "note"), counted(0, "note")
    ('1 note', '2 notes', '')
    """
    return f"{count} {word}{'s' if count > 1 else ''}" if count else ""
