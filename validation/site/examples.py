"""The pages of the examples: one for each script, and a list with small pictures."""

from __future__ import annotations

from pathlib import Path
from shutil import copyfile

from metafem.drawing.inline import drawn
from validation.pages import site_page
from validation.site.code import highlighted
from validation.site.docstrings import html, summary
from validation.site.extras import refuse_missing_docs
from validation.site.interface import addresses
from validation.site.scripts import run, scripts


def beside(name: str) -> str | None:
    """Return the address of a public name, such as ``mf.design``, as seen from the pages of the examples."""
    address = addresses().get(name)
    return None if address is None else f"../api/{address}"


def write_examples(folder: Path) -> list[str]:
    """Run the examples, write pages and scripts into ``folder/examples``, and return the addresses."""
    refuse_missing_docs()
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
            learned=html(script.text, beside),
            code=highlighted(script.code, beside),
            output=found.output,
            drawn=picture,
            before=listed[number - 1] if number else None,
            after=listed[number + 1] if number + 1 < len(listed) else None,
        )
        (pages / f"{script.name}.html").write_text(text, "utf-8")
        copyfile(script.path, pages / script.path.name)
        cards.append((script, picture.svg, summary(script.lesson, lambda name: None)))
    text = site_page("examples.html", here="examples/index.html", cards=cards, count=len(listed))
    (pages / "index.html").write_text(text, "utf-8")
    return ["examples/index.html", *(f"examples/{script.name}.html" for script in listed)]
