"""Where the command line writes: standard output that a program reads, and files that are replaced together."""

from __future__ import annotations

import contextlib
import math
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fricmb.errors import SceneError

_aside: list[Any] = []


@contextlib.contextmanager
def stdout_to_stderr(active: bool) -> Iterator[None]:
    """Let all that is printed go to stderr, that of compiled libraries and of other processes as well."""
    if not active:
        yield
        return
    out = sys.stdout
    kept = _redirected(out)
    _aside.append((out, kept))
    try:
        with contextlib.redirect_stdout(sys.stderr or out):
            yield
    finally:
        _aside.pop()
        if kept is not None:
            os.dup2(kept, out.fileno())
            os.close(kept)


def _redirected(out: Any) -> int | None:
    """A copy of the descriptor of standard output, which now is that of stderr; None where there is none."""
    try:
        out.flush()
        kept = os.dup(out.fileno())
        os.dup2(sys.stderr.fileno(), out.fileno())
    except (OSError, ValueError, AttributeError):
        return None
    return kept


def print_aside(text: str) -> None:
    """Write to standard output itself within :func:`stdout_to_stderr`."""
    out, kept = _aside[-1]
    if kept is None:
        out.write(text)
        return
    data = text.encode()
    while data:
        data = data[os.write(kept, data) :]


def make_folder(folder: Path) -> None:
    """Make a folder for results; SceneError, which names the option, where there can be none."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SceneError(
            f"--out: got {str(folder)!r}, which cannot be made a folder: {error.strerror}; expected a folder, or a path"
            " for a new one"
        ) from error


def finite(tree: Any) -> Any:
    """JSON knows no NaN: null instead."""
    if isinstance(tree, dict):
        return {key: finite(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [finite(value) for value in tree]
    return None if isinstance(tree, float) and not math.isfinite(tree) else tree


def replace_together(folder: Path, write: Callable[[Path], list[str]], stale: tuple[str, ...]) -> list[str]:
    """Let ``write`` fill a folder, then put its files in place of those in ``folder``: all of them or none.

    ``stale``: names of files that go where there are no new ones.
    """
    new = Path(tempfile.mkdtemp(prefix=".fricmb-", dir=folder))
    moved: list[str] = []
    try:
        names = write(new)
        old = new / "old"
        old.mkdir()
        try:
            for name in dict.fromkeys((*names, *stale)):
                if (folder / name).exists():
                    os.replace(folder / name, old / name)
                    moved.append(name)
            for name in names:
                os.replace(new / name, folder / name)
        except BaseException:
            for name in set(names) - set(moved):
                (folder / name).unlink(missing_ok=True)
            for name in moved:
                os.replace(old / name, folder / name)
            raise
        return names
    finally:
        shutil.rmtree(new, ignore_errors=True)
