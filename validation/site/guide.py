"""The guide as pages: Markdown files of `validation/guide/`, which also read well in the repository."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

from validation.cited import IN_CODE, breaking
from validation.pages import site_page

FOLDER = Path(__file__).parents[1] / "guide"

# The pages in the order in which a newcomer reads them.
ORDER = (
    "start", "explorer", "design", "shapes", "models", "tolerances", "measurements", "commands",
    "words", "modules",
)  # fmt: skip

# The cells of tables, and the code in them.
CELL = re.compile(r"<td.*?</td>", re.DOTALL)
CODE = re.compile(r"(?<=<code>)[^<]*(?=</code>)")

# Files of the repository that the site shows elsewhere.
ELSEWHERE = {"proof.md": "../cost.html"}


@dataclass(frozen=True)
class GuidePage:
    """One Markdown file: a title, which is its first heading, and a body."""

    name: str

    @cached_property
    def text(self) -> str:
        """The Markdown text."""
        return (FOLDER / f"{self.name}.md").read_text("utf-8")

    @property
    def title(self) -> str:
        """The first heading."""
        return self.text.partition("\n")[0].removeprefix("# ")

    @property
    def body(self) -> str:
        """The rest as HTML, with anchors at its headings and links between the pages of the site."""
        from markdown_it import MarkdownIt

        parser = MarkdownIt("commonmark", {"html": False}).enable("table")
        tokens = parser.parse(self.text.partition("\n")[2])
        for token, inside in pairwise(tokens):
            if token.type == "heading_open":
                token.attrSet("id", anchor(inside.content))
        for token in tokens:
            token.children = _relinked(token.children or [])
        html = parser.renderer.render(tokens, parser.options, {})
        html = CELL.sub(lambda cell: CODE.sub(lambda code: breaking(code[0], IN_CODE), cell[0]), html)
        return html.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")


def guide() -> list[GuidePage]:
    """Return the pages in their order."""
    return [GuidePage(name) for name in ORDER]


def write_guide(folder: Path) -> None:
    """Write the pages into the folder `guide` of a folder."""
    target = folder / "guide"
    target.mkdir(parents=True, exist_ok=True)
    for page in guide():
        here = f"guide/{page.name}.html"
        text = site_page("guide.html", here=here, page=page, pages=guide())
        (folder / here).write_text(text, "utf-8")


def anchor(words: str) -> str:
    """Return the anchor of a heading, as repositories form it."""
    return re.sub(r"[^\w-]", "", words.lower().replace(" ", "-"))


def _relinked(tokens: list[Any]) -> list[Any]:
    """Lead links to other pages of the guide, and hold pictures; links to other files become text."""
    kept, dropped = [], False
    for token in tokens:
        if token.type == "link_open":
            href = str(token.attrGet("href"))
            path, mark, place = href.partition("#")
            if path in ELSEWHERE:
                token.attrSet("href", ELSEWHERE[path])
            elif path.removesuffix(".md") in ORDER:
                token.attrSet("href", path.replace(".md", ".html") + mark + place)
            elif not href.startswith(("https:", "#")):
                dropped = True
                continue
        if token.type == "image":
            picture = (FOLDER / str(token.attrGet("src"))).read_bytes()
            token.attrSet("src", "data:image/svg+xml;base64," + base64.b64encode(picture).decode("ascii"))
        if token.type == "link_close" and dropped:
            dropped = False
            continue
        kept.append(token)
    return kept
