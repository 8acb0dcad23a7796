"""Results of a sweep on disk, in one SQLite file, so that an interrupted sweep goes on where it stopped."""

from __future__ import annotations

import hashlib
import os
import pickle
import sqlite3
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from os import PathLike
from pathlib import Path
from typing import Any

from fricmb._sweep._fingerprint import Fingerprint
from fricmb._sweep._plain import pack, unpack
from fricmb.errors import SceneError, shown
from fricmb.integrate.compile.cache_files import say
from fricmb.integrate.compile.cache_trust import fault_of, fault_of_folder

#: Bytes of the digests of a run and of a result.
_DIGEST = 16
#: Seconds between two writes, and seconds that one waits for another process that writes.
_EVERY, _PATIENCE = 1.0, 60.0
_TABLE = "CREATE TABLE IF NOT EXISTS results (run BLOB PRIMARY KEY, form TEXT, held BLOB, digest BLOB) WITHOUT ROWID"


class Store:
    """A folder with a file of results, by what they are results of (scene, values, options, ``reduce``).

    Several sweeps may write to it at once.  Results that are plain data are kept as data; others are pickles, which are
    read only where nobody else can have written them.  Each has a digest: one that is damaged counts as none, which is
    said.

    Parameters
    ----------
    path : path
        Made if it does not exist.
    shared : tuple
        What all runs have in common.
    """

    def __init__(self, path: str | PathLike[str], shared: tuple[Any, ...]) -> None:
        if not isinstance(path, str | PathLike):
            raise SceneError(f"store: got {shown(path)}; expected a folder, or a path for a new one")
        self.path = Path(path)
        if self.path.exists() and not self.path.is_dir():
            raise SceneError(f"store: got {str(path)!r}, which is a file; expected a folder, or a path for a new one")
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            said = getattr(error, "strerror", None) or error
            raise SceneError(f"store: got {str(path)!r}, which cannot be made a folder: {said}") from error
        self.file = self.path / "results.sqlite"
        found = Fingerprint()
        self._shared = found.of(*shared)
        for thing in found.unseen:
            say(f"the store cannot see changes of {thing}: use another folder when it changes")
        self._said: set[str] = set()
        self._lock = threading.Lock()
        self._new: dict[bytes, tuple[str, bytes, bytes]] = {}
        self._timer: threading.Timer | None = None
        self._base = self._connected()

    def _connected(self) -> sqlite3.Connection | None:
        """The file, made if it is not there; None, which is said, where it cannot be used."""
        for again in (False, True):
            base = None
            try:
                # results go from one thread at a time into it, but not always from the same
                base = sqlite3.connect(self.file, timeout=_PATIENCE, check_same_thread=False)
                base.execute(_TABLE)
                base.execute("SELECT run FROM results LIMIT 1").fetchall()
                return base
            except sqlite3.Error as error:
                if base is not None:
                    base.close()
                if again or isinstance(error, sqlite3.OperationalError):
                    self._say(f"results cannot be kept in {self.path}: {error}")
                    return None
                self._put_aside(error)
        return None

    def _put_aside(self, error: sqlite3.Error) -> None:
        aside = self.file.with_name(f"{self.file.name}.damaged")
        say(f"kept results are damaged ({error}) and are made again; the file is now {aside}")
        with suppress(OSError):
            os.replace(self.file, aside)

    def _say(self, text: str) -> None:
        if text not in self._said:
            self._said.add(text)
            say(text)

    def key(self, parameters: Mapping[str, Any]) -> bytes:
        """What one run is known by."""
        if set(map(type, parameters.values())) <= {float}:  # as in most sweeps: in a seventh of the time
            text = repr(sorted((name, value.hex()) for name, value in parameters.items()))
            return hashlib.sha256(f"{self._shared} {text}".encode()).digest()[:_DIGEST]
        return bytes.fromhex(Fingerprint().of(self._shared, parameters))[:_DIGEST]

    def among(self, runs: Sequence[Mapping[str, Any]], told: Callable[[], object]) -> Iterator[tuple[int, Any]]:
        """The results that are there of many runs, by their places; ``told`` is called for each run."""
        known: set[bytes] = set()
        if self._base is not None:
            with suppress(sqlite3.Error):  # said by get
                known = {key for (key,) in self._base.execute("SELECT run FROM results")}
        for i, parameters in enumerate(runs if known else ()):
            if self.key(parameters) in known:
                there, result = self.get(parameters)
                if there:
                    yield i, result
            told()

    def get(self, parameters: Mapping[str, Any]) -> tuple[bool, Any]:
        """Whether the run was made before, and its result; what cannot be read counts as none."""
        if self._base is None:
            return False, None
        key = self.key(parameters)
        try:
            with self._lock:
                row = self._new.get(key) or self._base.execute(
                    "SELECT form, held, digest FROM results WHERE run = ?", (key,)
                ).fetchone()  # fmt: skip
        except sqlite3.Error as error:
            self._say(f"kept results cannot be read and are made again: {self.file} ({error})")
            return False, None
        return (False, None) if row is None else self._result(*row)

    def _result(self, form: str, held: bytes, digest: bytes) -> tuple[bool, Any]:
        if not isinstance(held, bytes) or hashlib.sha256(held).digest()[:_DIGEST] != digest:
            self._say(f"a kept result is damaged and is made again: {self.file}")
            return False, None
        if form != "plain":
            fault = self._fault()
            if fault is not None:
                self._say(f"results in {self.path} that are pickles are not used, since {fault}: `chmod go-w` it")
                return False, None
        try:
            return True, unpack(held) if form == "plain" else pickle.loads(held)
        except Exception as error:  # of a class that is gone, say
            self._say(f"a kept result cannot be read and is made again: {self.file} ({error})")
            return False, None

    def _fault(self) -> str | None:
        """Why somebody else may have written what is kept."""
        fault = fault_of(self.file.stat())
        return fault_of_folder(self.path) if fault is None else f"{self.file} {fault}"

    def put(self, parameters: Mapping[str, Any], result: Any) -> None:
        """Keep a result, on disk within a second.  A full disk is said, and the sweep goes on."""
        held = pack(result)
        form = "pickle" if held is None else "plain"
        if held is None:
            held = pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
        if self._base is None:
            return
        with self._lock:
            self._new[self.key(parameters)] = form, held, hashlib.sha256(held).digest()[:_DIGEST]
            if self._timer is None:
                self._timer = threading.Timer(_EVERY, self.write)
                self._timer.daemon = True
                self._timer.start()

    def write(self) -> None:
        """Put on disk what came in since the last time, at once and within a moment: others may wait."""
        with self._lock:
            self._timer = None
            if self._base is None or not self._new:
                return
            rows = [(key, *row) for key, row in self._new.items()]
            try:
                with self._base:
                    self._base.executemany("INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?)", rows)
            except sqlite3.Error as error:  # kept for the next time
                self._say(f"results cannot be kept in {self.path}: {error}")
            else:
                self._new.clear()

    def close(self) -> None:
        """Put on disk what is not there yet."""
        if self._timer is not None:
            self._timer.cancel()
        self.write()
        if self._base is not None:
            self._base.close()
            self._base = None
