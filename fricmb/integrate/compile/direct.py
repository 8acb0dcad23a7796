"""Calls of compiled entries from Python that are made many times over, with arguments of the same types each time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Direct:
    """An entry, called without looking up the types of its arguments: that takes longer than most entries do.

    The first call is an ordinary one, by which the entry is compiled or loaded.  Entries have one signature, that of
    their annotations; what is handed over later has to obey it as well, since nothing looks any more.
    """

    def __init__(self, entry: Callable[..., Any]) -> None:
        self._entry: Any = entry
        self._call: Callable[..., Any] | None = None

    def __call__(self, *arguments: Any) -> Any:
        """As the entry."""
        if self._call is not None:
            return self._call(*arguments)
        found = self._entry(*arguments)
        known = list(self._entry.overloads.values())
        if len(known) == 1:
            self._call = known[0].entry_point
        return found
