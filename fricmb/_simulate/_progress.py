"""Progress bars on the terminal: over the time of a run, and over pieces of work of any kind."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from fricmb.errors import SceneError
from fricmb.errors import shown as shown_as
from fricmb.values import is_flag

Progress = Callable[[float], None]
#: Told how many pieces of work are done, and the name of the one under way.
Told = Callable[[int, str], None]


def _is_shown(progress: Any) -> bool:
    if not is_flag(progress):
        raise SceneError(f"progress: got {shown_as(progress)}; expected True or False")
    return bool(progress)


@contextmanager
def progress_bar(shown: bool, t_start: float, t_end: float) -> Iterator[Progress | None]:
    """A bar over simulated time on stderr, as a function of the time reached; None if it is not to be shown."""
    if not _is_shown(shown):
        yield None
        return
    from tqdm import tqdm

    form = "{desc}: {percentage:3.0f}%|{bar}| t = {n:.4g} of {total:.4g} [{elapsed}<{remaining}]"
    with tqdm(total=t_end - t_start, desc="fricmb", bar_format=form, **bar_options()) as bar:
        yield _forward(bar, t_start)
        # methods tell of whole pieces of work, the last of which may end before the run does
        bar.update(t_end - t_start - bar.n)


class _NoBar:
    """No bar: tqdm would start a thread even for one that is not shown."""

    def update(self, n: int = 1) -> None:
        """Nothing."""


@contextmanager
def bar(total: int, unit: str, what: str, shown: bool, *, done: int = 0) -> Iterator[Any]:
    """A bar over pieces of work with ``update(n)``, or nothing that has the same; ``done``: pieces that are there."""
    if not _is_shown(shown):
        yield _NoBar()
        return
    from tqdm import tqdm

    with tqdm(total=total, initial=done, unit=unit, desc=what, **bar_options()) as made:
        yield made


@contextmanager
def named_bar(total: int, what: str, shown: bool) -> Iterator[Told]:
    """A bar over pieces of work that are as unlike as their names: drawn whenever one begins, full at the end.

    Parameters
    ----------
    total : int
        Number of pieces.
    what : str
        Of which they are pieces.
    shown : bool

    Yields
    ------
    callable
        To be told how many pieces are done, and the name of the one under way.
    """
    if not shown:
        yield _say_nothing
        return
    from tqdm import tqdm

    class Bar(tqdm):  # type: ignore[type-arg]
        monitor_interval = 0  # no thread: processes may be forked while it is shown

    form = "{desc}: {percentage:3.0f}%|{bar}| {n_fmt}/{total_fmt} [{elapsed}]{postfix}"
    with Bar(total=total, desc=what, bar_format=form, **bar_options()) as made:

        def tell(done: int, name: str) -> None:
            made.n = min(done, total)
            made.set_postfix_str(name)

        yield tell
        tell(total, "")


def _say_nothing(done: int, name: str) -> None:
    """What is told where no bar is shown."""


def bar_options() -> dict[str, Any]:
    """What every bar is told: to be drawn again however little was done, for work that begins fast may turn slow.

    And the size of a terminal that says it has none, as those of containers do.
    """
    often = {"miniters": 0}
    try:
        columns, lines = os.get_terminal_size(sys.stderr.fileno())
    except (OSError, ValueError, AttributeError):
        return often
    return often if columns and lines else often | {"ncols": columns or 80, "nrows": lines or 24}


def _forward(bar: Any, t_start: float) -> Progress:
    """The bar's clock starts with the first piece of work that is told: before it kernels are loaded or compiled."""

    def forward(t: float) -> None:
        if bar.n == 0.0:
            bar.n = bar.initial = bar.last_print_n = t - t_start
            bar.start_t = bar.last_print_t = time.time()
        bar.update(max(t - t_start - bar.n, 0.0))

    return forward
