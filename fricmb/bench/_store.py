"""Outcomes on disk as they come, so that a suite that was interrupted goes on where it stopped."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any


class Store:
    """One JSON object a line; a line that was cut off counts as not written.

    Parameters
    ----------
    path : Path or None
        None: kept in memory alone.
    fingerprint : str
        Of what is measured (version, options): results of something else are not taken over.
    """

    def __init__(self, path: Path | None, fingerprint: str) -> None:
        self._path = path
        self._fingerprint = fingerprint
        self._held: dict[str, Any] = {}
        if path is not None and path.exists():
            self._held = dict(self._read(path))
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)

    def _read(self, path: Path) -> Iterator[tuple[str, Any]]:
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            if row.get("of") == self._fingerprint:
                yield row["key"], row["value"]

    def get(self, key: str) -> Any:
        """What was kept under that key, or None."""
        return self._held.get(key)

    def put(self, key: str, value: Any) -> None:
        """Keep a value, on disk at once."""
        self._held[key] = value
        if self._path is not None:
            with self._path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps({"of": self._fingerprint, "key": key, "value": value}) + "\n")

    def clear(self) -> None:
        """Forget everything."""
        self._held.clear()
        if self._path is not None:
            self._path.unlink(missing_ok=True)

    def __len__(self) -> int:
        return len(self._held)
