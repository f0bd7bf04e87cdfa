"""A dimensioned drawing of the mould in SVG, true to scale.

Each hole is one short element, so that a drawing of 10,000 holes has less than a megabyte. Coordinates in the
drawing are millimetres on the sheet.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np

from metafem._validate import FloatArray
from metafem.caps import SPHERE, Caps
from metafem.files.caps import cap_text
from metafem.files.part.block import mirrored
from metafem.surface import Block, Surface

# Scales of ISO 5455, largest first, and the largest side of the plan view, for an A3 sheet [mm].
_SCALES = tuple(a * 10.0**k for k in range(2, -4, -1) for a in (5.0, 2.0, 1.0))
_PLAN = 240.0

# Margins left of, above and right of the plan view, space between the view and the notes, and distance
# between lines of text [mm].
_LEFT, _TOP, _RIGHT, _BELOW, _LINE = 32.0, 36.0, 32.0, 28.0, 5.5

# Distance of dimension lines from the outline, and size of arrows and letters [mm].
_FAR, _ARROW, _TEXT = 10.0, 2.5, 3.5

# Arrow at the end of a dimension line.
_ARROWHEAD = (
    f'<marker id="arrow" viewBox="-{_ARROW} -.4 {_ARROW} .8" refX="0" refY="0" markerWidth="{_ARROW}" '
    'markerHeight=".8" markerUnits="userSpaceOnUse" orient="auto">'
    f'<path d="M0 0L-{_ARROW} .4V-.4Z"/></marker>'
)

# Least width of a sheet, at which the notes fit on it [mm].
_NARROWEST = 190.0

# Largest number of holes labelled with their numbers in mould.csv.
_MOST_NUMBERED = 144

# Line style of each tool: colour and dashes. If there are more tools than styles, all tools have the first.
_TOOLS = (
    ("#1b6f8a", ""),
    ("#c8553d", "1.5 .8"),
    ("#5b8c3a", "3 .8"),
    ("#7a4fa3", ".6 .6"),
    ("#a07d1c", "3 .8 .6 .8"),
)

# Holes are in the same column or row if their positions differ by less than this fraction of the range.
_SAME = 1e-9


def mould_drawing(surface: Surface, asperities: int, block: Block) -> str:
    """Return the drawing of a mould, seen from its open face, as the text of an SVG file.

    The first `asperities` caps of the surface are those of the design, and all others are for alignment.
    """
    position = mirrored(surface.position)
    scale = next((s for s in _SCALES if s * max(block.width, block.length) <= _PLAN), _SCALES[-1])
    wide, high = scale * block.width, scale * block.length
    left = _LEFT + 0.5 * max(_NARROWEST - _LEFT - _RIGHT - wide, 0.0)
    tools = _tools(surface)
    notes = _notes(surface, asperities, block, scale)
    bottom = _TOP + high
    sheet = (max(_NARROWEST, _LEFT + wide + _RIGHT), bottom + _BELOW + _LINE * (len(notes) + len(tools) + 1))
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{sheet[0]:.7g}mm" height="{sheet[1]:.7g}mm" '
        f'viewBox="0 0 {sheet[0]:.7g} {sheet[1]:.7g}" font-family="sans-serif" font-size="{_TEXT}">',
        f"<title>Mould: {surface.count} holes</title>",
        _ARROWHEAD,
        f'<rect width="{sheet[0]:.7g}" height="{sheet[1]:.7g}" fill="#fff"/>',
        f'<text x="{_LEFT}" y="8" font-size="5">Mould, seen from its open face</text>',
        '<g fill="none" stroke="#000">',
        f'<rect x="{left:.7g}" y="{_TOP}" width="{wide:.7g}" height="{high:.7g}" stroke-width=".5"/>',
        _centre_lines(left, wide, high),
    ]
    x, y = left + 0.5 * wide + scale * position[:, 0], _TOP + 0.5 * high - scale * position[:, 1]
    rim = scale * surface.cap.foot_radius(surface.height, surface.radius)
    for (colour, dashes), (which, _) in zip(_TOOLS, tools, strict=False):
        lines.append(f'<g stroke="{colour}" stroke-width=".25" stroke-dasharray="{dashes or "none"}">')
        lines += [f'<circle cx="{x[i]:.6g}" cy="{y[i]:.6g}" r="{rim[i]:.3g}"/>' for i in which]
        lines.append("</g>")
    lines += [_cross(x[i], y[i], 1.4 * rim[i]) for i in range(asperities, surface.count)]
    lines += ["</g>", '<g text-anchor="middle" fill="#333">']
    if surface.count <= _MOST_NUMBERED:
        size = min(_TEXT, 0.9 * float(rim.min()))
        shift = np.where(np.arange(surface.count) < asperities, 0.0, rim + 0.5 * size)  # next to a cross
        lines += [
            f'<text x="{x[i] + shift[i]:.6g}" y="{y[i] + 0.35 * size - shift[i]:.6g}" '
            f'font-size="{size:.3g}">{i + 1}</text>'
            for i in range(surface.count)
        ]
    lines.append("</g>")
    lines.append('<g stroke="#000" stroke-width=".2" text-anchor="middle">')
    lines += _dimension(left, left + wide, bottom, bottom + _FAR, f"{block.width:.7g}")
    lines += _chain(np.sort(x), left, _TOP, _TOP - _FAR, scale)
    lines.append('<g transform="rotate(-90)">')  # along is -y, and across is x
    lines += _dimension(-bottom, -_TOP, left, left - _FAR, f"{block.length:.7g}")
    lines += _chain(np.sort(-y), -bottom, left + wide, left + wide + _FAR, scale)
    lines.append("</g></g>")
    start = bottom + _BELOW
    for k, ((colour, dashes), (_, words)) in enumerate(zip(_TOOLS, tools, strict=False)):
        level = start + _LINE * k
        lines.append(
            f'<circle cx="{_LEFT + 2}" cy="{level - 1.2:.7g}" r="1.6" fill="none" stroke="{colour}" '
            f'stroke-width=".35" stroke-dasharray="{dashes or "none"}"/>'
            f'<text x="{_LEFT + 6}" y="{level:.7g}">{escape(words)}</text>'
        )
    for k, words in enumerate(notes, len(tools)):
        lines.append(f'<text x="{_LEFT}" y="{start + _LINE * k:.7g}">{escape(words)}</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def _tools(surface: Surface) -> list[tuple[list[int], str]]:
    """Return the indices of the holes of each tool, and a description of these holes.

    If there are more tools than line styles, all tools are described as one.
    """
    radii, mixed = np.unique(surface.radius), isinstance(surface.cap, Caps)
    every = [(float(r), surface.cap.one(i) if mixed else None) for i, r in enumerate(surface.radius)]
    kinds = sorted(set(every), key=repr)
    if len(kinds) > len(_TOOLS):
        words = f"{surface.count} holes, {len(kinds)} tools, radii R from {radii[0]:.6g} to {radii[-1]:.6g}"
        return [(list(range(surface.count)), f"{words}, {_depths(surface.height)}")]
    tools = []
    for kind in kinds:
        radius, cap = kind
        which = [i for i, own in enumerate(every) if own == kind]
        depth, shape = _depths(surface.height[which]), f", {cap_text(cap)}" if cap else ""
        tools.append((which, f"{len(which)} holes, tool radius R {radius:.6g}{shape}, {depth}"))
    return tools


def _depths(height: FloatArray) -> str:
    low, high = float(height.min()), float(height.max())
    return f"depth {low:.5g}" if low == high else f"depths from {low:.5g} to {high:.5g}"


def _notes(surface: Surface, asperities: int, block: Block, scale: float) -> list[str]:
    ratio = f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"
    rows = "by its number" if surface.count <= _MOST_NUMBERED else "one row for each"
    notes = [
        f"Lengths in mm. Scale {ratio}. Circles: rims of the holes in the face.",
        "Datum: centre of the outline, on the face. The part lies face down on it: x is mirrored, x -> -x.",
        f"Position, depth and tool radius of each hole: mould.csv, {rows}.",
        f"Depths are below the face; the part above it is {block.thickness:.7g} thick.",
    ]
    if surface.cap != SPHERE:
        notes.insert(3, f"Profile of the holes: {surface.cap!r}.")
    if asperities < surface.count:
        notes.insert(3, "Holes with a cross: alignment asperities, which are cut off the part in the end.")
    return notes


def _centre_lines(left: float, wide: float, high: float) -> str:
    x, y, over = left + 0.5 * wide, _TOP + 0.5 * high, 3.0
    return (
        f'<path d="M{left - over:.6g} {y:.6g}H{left + wide + over:.6g}M{x:.6g} {_TOP - over:.6g}'
        f'V{_TOP + high + over:.6g}" stroke="#888" stroke-width=".15" stroke-dasharray="6 1 1 1"/>'
    )


def _cross(x: float, y: float, size: float) -> str:
    return (
        f'<path d="M{x - size:.6g} {y:.6g}h{2 * size:.4g}M{x:.6g} {y - size:.6g}v{2 * size:.4g}" '
        'stroke-width=".15"/>'
    )


def _chain(position: FloatArray, edge: float, side: float, level: float, scale: float) -> Iterator[str]:
    """Yield the dimension from an edge to the first column or row, and the dimension of the pitch."""
    first = float(position[0])
    pitch = _pitch(position)
    words = f"{abs(first - edge) / scale:.5g}"
    yield from _dimension(min(edge, first), max(edge, first), side, level, words)
    if pitch is not None:
        words = f"pitch {pitch / scale:.6g}"
        yield from _dimension(first, first + pitch, side, level, words, beside=True)


def _pitch(position: FloatArray) -> float | None:
    """Return the common step of sorted positions; None if their distances are not multiples of one step."""
    extent = float(np.ptp(position))
    steps = np.diff(position)
    steps = steps[steps > _SAME * extent]
    if not len(steps):
        return None
    pitch = float(steps.min())
    multiples = steps / pitch
    return pitch if np.allclose(multiples, np.round(multiples), rtol=0.0, atol=1e-6) else None


def _dimension(
    start: float, end: float, edge: float, level: float, words: str, *, beside: bool = False
) -> Iterator[str]:
    """Yield the elements of a dimension: its line, extension lines from the edge, arrows and text."""
    over, middle = level + np.sign(level - edge), 0.5 * (start + end)
    extensions = "".join(f"M{tip:.6g} {edge:.6g}V{over:.6g}" for tip in (start, end))
    yield f'<path d="{extensions}M{start:.6g} {level:.6g}H{end:.6g}"/>'
    # at a short line, the arrows are outside and point to its ends
    short = end - start <= 3.0 * _ARROW
    for tip, outside in ((start, start - 2.0 * _ARROW), (end, end + 2.0 * _ARROW)):
        tail = outside if short else middle
        yield f'<path d="M{tail:.6g} {level:.6g}H{tip:.6g}" marker-end="url(#arrow)"/>'
    along, across, anchor = middle, level - 1.0, ""
    if beside:
        along, across, anchor = end + _ARROW + 1.0, level + 0.35 * _TEXT, ' text-anchor="start"'
    elif end - start < 0.6 * _TEXT * len(words):
        along, anchor = middle - _ARROW, ' text-anchor="end"'
    yield f'<text x="{along:.6g}" y="{across:.6g}"{anchor} stroke="none">{words}</text>'
