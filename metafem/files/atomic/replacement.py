"""Replacement of several files of a folder, completely or not at all.

No system call replaces a set of files at once. With two renames of folders there is a moment without the old
one, and files of other origin move too. Here the old files stay in their folder until each is replaced by one
rename. Hard links to them, and a journal that exists from before the first rename until after the last, allow
an interrupted replacement to be undone: at once after an error or a signal, else on the next run. Until then
the folder may hold files of both versions.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection, Mapping
from pathlib import Path

from metafem.errors import InvalidInput
from metafem.files.atomic.manifest import Hashes, digest, unchanged

NEW, OLD, JOURNAL, UNFINISHED = "new", "old", "journal.json", "journal.part"


def replace_files(work: Path, folder: Path, ours: Hashes, stale: Collection[str] = ()) -> None:
    """Move the files of `work`/new into the folder, and remove the stale ones that are not among them.

    Only files that still have a hash in `ours` are replaced or removed. Raise InvalidInput if a file has the
    name of a new one and is not ours; the folder is then as it was.
    """
    fresh = {path.name: digest(path) for path in sorted((work / NEW).iterdir())}
    known = {name: ours.get(name, frozenset()) | {fresh.get(name, "")} for name in {*fresh, *stale}}
    there = {name for name in known if os.path.lexists(folder / name)}
    mine = {name for name in there if unchanged(folder / name, known[name])}
    refuse_foreign(folder, sorted((there - mine) & set(fresh)), ours)
    (work / OLD).mkdir()
    for name in sorted(mine):
        _link(folder / name, work / OLD / name)
    if mine:  # the new files are on the disk before old ones are removed
        for name in fresh:
            _flush(work / NEW / name)
    added = {name: fresh[name] for name in set(fresh) - there}
    journal = {"added": added, "ours": {name: sorted(known[name]) for name in mine}}
    (work / UNFINISHED).write_text(json.dumps(journal), encoding="utf-8")
    _flush(work / UNFINISHED)
    (work / UNFINISHED).replace(work / JOURNAL)
    for name in mine - set(fresh):
        (folder / name).unlink()
    for name in fresh:
        if name in mine:
            (work / NEW / name).replace(folder / name)
        else:  # fails if such a file was made in the meantime
            _link(work / NEW / name, folder / name)
    (work / JOURNAL).unlink()


def undo(work: Path, folder: Path) -> None:
    """Undo an interrupted replacement; files that were changed since then stay."""
    try:
        journal = json.loads((work / JOURNAL).read_text(encoding="utf-8"))
        added = {Path(name).name: str(each) for name, each in journal["added"].items()}
        ours = {str(name): frozenset(map(str, each)) for name, each in journal["ours"].items()}
    except FileNotFoundError:
        return
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InvalidInput(
            f"{work / JOURNAL} is damaged: a run was interrupted while it replaced files of {folder}; its "
            f"old files are in {work / OLD}: copy those that you need, then remove {work}"
        ) from None
    for name, each in added.items():
        if unchanged(folder / name, frozenset({each})):
            (folder / name).unlink()
    for path in sorted((work / OLD).iterdir()):
        there = folder / path.name
        if not os.path.lexists(there) or unchanged(there, ours.get(path.name, frozenset())):
            path.replace(there)
    (work / JOURNAL).unlink()


def refuse_foreign(folder: Path, names: Collection[str], ours: Mapping[str, object]) -> None:
    """Raise InvalidInput if there are names: files that metafem did not write, or that were changed."""
    if not names:
        return
    facts = {
        name: "was changed since metafem wrote it" if name in ours else "was not written by metafem"
        for name in sorted(names)
    }
    raise InvalidInput(
        "\n".join(
            f"{folder / name} {fact}, so it is not replaced; rename it, or choose another name"
            for name, fact in facts.items()
        )
    )


def _link(source: Path, goal: Path) -> None:
    """Make a hard link with a new name, or a copy if the disk does not support links."""
    try:
        os.link(source, goal)
    except FileExistsError:
        raise
    except OSError:
        with source.open("rb") as old, goal.open("xb") as new:
            shutil.copyfileobj(old, new)


def _flush(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())
