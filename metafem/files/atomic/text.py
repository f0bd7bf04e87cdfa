"""Files that are written completely or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from metafem.errors import InvalidInput
from metafem.files.atomic.claim import SUFFIX, claimed, reason
from metafem.files.atomic.manifest import MANIFEST, Hashes, digest, manifest_text, unchanged, written
from metafem.files.atomic.replacement import NEW, refuse_foreign, replace_files


def write_text(path: str | Path, text: str, **options: Any) -> None:
    """Write a text in UTF-8 by `write_file`, with its options."""
    write_file(path, lambda fresh: fresh.write_bytes(text.encode("utf-8")), **options)


def write_file(
    path: str | Path,
    write: Callable[[Path], object],
    *,
    force: bool = False,
    ours: Callable[[bytes], bool] = lambda _: True,
    still: Callable[[], None] = lambda: None,
    fixed: bool = False,
) -> None:
    """Write a file by the function `write` under another name, and rename it.

    With `force` an existing file is replaced: in a result folder one that metafem wrote and that was not
    changed, elsewhere one whose content `ours` accepts as metafem's. `still` raises an error if the content
    is not valid any more, and is called before the file is renamed. `fixed` says that no other name can be
    chosen. Raise InvalidInput if the file exists or
    cannot be written; no unfinished file is left.
    """
    target = Path(path).absolute()
    refuse_existing(target, force, ours, fixed)
    try:
        with claimed(target.parent / SUFFIX, target) as work:
            write(work / NEW / target.name)
            still()
            refuse_existing(target, force, ours, fixed)
            before = _before(target, ours)
            if (manifest := target.with_name(MANIFEST)).is_file():
                fresh = {target.name: frozenset({digest(work / NEW / target.name)})}
                (work / NEW / MANIFEST).write_text(manifest_text({**before, **fresh}), encoding="utf-8")
                before = {**before, MANIFEST: frozenset({digest(manifest)})}
            replace_files(work, target.parent, before)
    except OSError as error:
        raise InvalidInput(f"{target} cannot be written: {reason(error)}") from None


def refuse_existing(
    path: str | Path, force: bool, ours: Callable[[bytes], bool] = lambda _: True, fixed: bool = False
) -> None:
    """Raise InvalidInput if `write_file` would refuse the file, before a long run."""
    target = Path(path).absolute()
    if not os.path.lexists(target):
        return
    if not force:
        other = "" if fixed else "choose another name, or "
        raise InvalidInput(f"{target} exists; {other}replace it with force=True")
    if target.is_symlink() or not target.is_file():
        kind = "a link" if target.is_symlink() else "a folder" if target.is_dir() else "no regular file"
        raise InvalidInput(f"{target} cannot be written: it is {kind}; choose another name")
    before = _before(target, ours)
    if not unchanged(target, before.get(target.name, frozenset())):
        refuse_foreign(target.parent, [target.name], before)


def _before(target: Path, ours: Callable[[bytes], bool]) -> Hashes:
    """Return the files that metafem wrote: of a result folder all, elsewhere the target only."""
    if target.with_name(MANIFEST).is_file():
        return written(target.parent)
    if target.is_file() and ours(target.read_bytes()):
        return {target.name: frozenset({digest(target)})}
    return {}
