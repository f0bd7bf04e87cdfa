"""Python code with marked syntax, in the colours of the page."""

from __future__ import annotations

import re
from collections.abc import Callable

# A dotted name that begins with mf, as pygments marks it, and one of its parts.
DOTTED = re.compile(r'<span class="n">mf</span>(?:<span class="o">\.</span><span class="n">\w+</span>)+')
PART = re.compile(r'<span class="o">\.</span><span class="n">(\w+)</span>')


def highlighted(code: str, address: Callable[[str], str | None]) -> str:
    """Return code as HTML, whose classes `code.css` colours; public names are links to their `address`."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import PythonLexer

    text = str(highlight(code, PythonLexer(), HtmlFormatter(cssclass="code")))
    return DOTTED.sub(lambda found: _linked(found[0], address), text)


def _linked(text: str, address: Callable[[str], str | None]) -> str:
    """Return a dotted name as a link to the longest part of it that is public."""
    for end in reversed([found.end() for found in PART.finditer(text)]):
        target = address(".".join(["mf", *PART.findall(text[:end])]))
        if target is not None:
            return f'<a href="{target}">{text[:end]}</a>{text[end:]}'
    return text
