"""Docstrings of numpydoc as parts of a page: paragraphs, lists of parameters, and examples as code."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape

# Text in backticks, single or double, which Markdown leaves alone.
CODE_SPAN = re.compile(r"(``.+?``|`[^`]+`)", re.DOTALL)

# A word or words between asterisks, as in *rescaled*; other asterisks are those of E* and of products.
EMPHASIS = re.compile(r"(?<![\w*])\*(\w[^*\n]*\w|\w)\*(?![\w*])")

# Signs with a meaning in Markdown or HTML, except in code.
SPECIAL = re.compile(r"([\\*_\[\]<])")

HEADING = re.compile(r'<h6 id="[^"]*">(.*?)</h6>')
PARAMETER = re.compile(r"<li>(?:<p>)?<strong>(.*?)</strong>(?: \((.*)\))?:?\s*(?:</p>\s*)?")
WORD = re.compile(r"[A-Za-z_][\w.]*")
LINK_CANDIDATE = re.compile(r"<code>([A-Za-z_][\w.]*)((?:\([^<]*\))?)</code>")
DOI = re.compile(r"\bdoi:(10\.\d{4,}/(?:[^\s,;()<]|\([^\s()<]*\))*[^\s,;(<.])(?<!\))")

Address = Callable[[str], str | None]


def html(docstring: str, address: Address) -> str:
    """Return a docstring as HTML; `address` gives the address of a public name, or None."""
    from pdoc.docstrings import convert
    from pdoc.render_helpers import to_html

    text = str(to_html(convert(_literal(docstring), "numpy", None)))
    for sign in "\\*_[]<":  # they have no meaning any more
        text = text.replace(f"&#{ord(sign)};", escape(sign))
    text = text.replace('<div class="pdoc-code codehilite">', '<div class="code">')
    text = HEADING.sub(r"<h4>\1</h4>", text)
    text = PARAMETER.sub(lambda found: _parameter(found, address), text)
    text = DOI.sub(r'<a href="https://doi.org/\1">doi:\1</a>', text)
    return LINK_CANDIDATE.sub(lambda found: _linked(found, address), text)


def summary(docstring: str, address: Address) -> str:
    """Return the first paragraph of a docstring as HTML without an enclosing paragraph."""
    return html(docstring.partition("\n\n")[0], address).strip().removeprefix("<p>").removesuffix("</p>")


def _literal(docstring: str) -> str:
    """Return a docstring in which signs such as the asterisk of E* mean themselves."""
    parts = []
    for block in re.split(r"(\n\s*\n)", docstring):
        code = block.lstrip().startswith(">>>")
        parts.append(block if code else _escaped(block))
    return "".join(parts)


def _escaped(block: str) -> str:
    """Return a paragraph, or a section, whose special signs outside code are escaped."""
    lines, _, code = block.partition("\n>>> ")
    pieces = CODE_SPAN.split(lines)
    for i in range(0, len(pieces), 2):
        marked = EMPHASIS.sub("\0\\1\0", pieces[i]).replace("mm^2", "mm²")
        pieces[i] = SPECIAL.sub(_entity, marked).replace("\0", "*")
    return "".join(pieces) + (f"\n>>> {code}" if code else "")


def _entity(found: re.Match[str]) -> str:
    return f"&#{ord(found[1])};"


def _parameter(found: re.Match[str], address: Address) -> str:
    """Return the head of an entry of a list: the name, and the type with links."""
    name, kind = found.groups()
    if kind is None:
        shown, kind = linked(name, address), ""
    else:
        shown, kind = name, f' <span class="quiet">{linked(kind, address)}</span>'
    return f"<li><b>{shown}</b>{kind}<br>"


def linked(text: str, address: Address) -> str:
    """Return a text in which public names are links."""
    return WORD.sub(
        lambda found: f'<a href="{target}">{found[0]}</a>' if (target := address(found[0])) else found[0],
        text,
    )


def _linked(found: re.Match[str], address: Address) -> str:
    """Return a name in code, as a link if it is public."""
    name, call = found.groups()
    target = address(name)
    shown = f"<code>{name}{call}</code>"
    return shown if target is None else f'<a href="{target}">{shown}</a>'
