"""Bars on the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class _NoBar:
    def update(self, n: int = 1) -> None:
        """Nothing."""


@contextmanager
def bar(total: int, unit: str, what: str, shown: bool) -> Iterator[Any]:
    """A bar with ``update(n)``, or nothing that has the same."""
    if not shown:
        yield _NoBar()
        return
    from tqdm import tqdm

    with tqdm(total=total, unit=unit, desc=what) as made:
        yield made
