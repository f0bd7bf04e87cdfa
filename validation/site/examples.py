"""The pages of the examples: one for each script, and a list with small pictures."""

from __future__ import annotations

from pathlib import Path
from shutil import copyfile

from metafem.drawing.inline import drawn
from validation.pages import site_page
from validation.site.scripts import run, scripts


def write_examples(folder: Path) -> None:
    """Run the examples, and write pages and scripts into ``folder/examples``."""
    from markdown_it import MarkdownIt
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import PythonLexer

    pages = folder / "examples"
    pages.mkdir(parents=True, exist_ok=True)
    listed = scripts()
    cards = []
    for number, script in enumerate(listed):
        found = run(script)
        picture = drawn(found.figure, script.title, script.caption)
        text = site_page(
            "example.html",
            here=f"examples/{script.name}.html",
            script=script,
            number=number + 1,
            count=len(listed),
            learned=MarkdownIt().render(script.text),
            code=highlight(script.code, PythonLexer(), HtmlFormatter(cssclass="code")),
            output=found.output,
            drawn=picture,
            before=listed[number - 1] if number else None,
            after=listed[number + 1] if number + 1 < len(listed) else None,
        )
        (pages / f"{script.name}.html").write_text(text, "utf-8")
        copyfile(script.path, pages / script.path.name)
        cards.append((script, picture.svg, script.lesson))
    text = site_page("examples.html", here="examples/index.html", cards=cards, count=len(listed))
    (pages / "index.html").write_text(text, "utf-8")
