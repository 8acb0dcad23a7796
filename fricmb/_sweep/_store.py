"""Results of a sweep on disk, one file a run, so that an interrupted sweep goes on where it stopped."""

from __future__ import annotations

import hashlib
import os
import pickle
import secrets
from os import PathLike
from pathlib import Path
from typing import Any

from fricmb._sweep._fingerprint import Fingerprint
from fricmb.errors import SceneError, shown
from fricmb.integrate.compile.cache_files import say

_DIGEST = 32


class Store:
    """A folder of pickled results, named by what they are results of (scene, values, options, ``reduce``).

    Each file begins with the digest of the rest: one that is damaged counts as none, which is said.

    Parameters
    ----------
    path : path
        Made if it does not exist.  Pickles: do not use a folder that others can write to.
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
        found = Fingerprint()
        self._shared = found.of(*shared)
        for thing in found.unseen:
            say(f"the store cannot see changes of {thing}: use another folder when it changes")
        self._full = False

    def file(self, parameters: dict[str, Any]) -> Path:
        """The file of one run."""
        return self.path / f"{Fingerprint().of(self._shared, parameters)[:32]}.pickle"

    def get(self, parameters: dict[str, Any]) -> tuple[bool, Any]:
        """Whether the run was made before, and its result; a file that cannot be read counts as none."""
        path = self.file(parameters)
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            return False, None
        except OSError as error:
            say(f"a result cannot be read and is made again: {path} ({error.strerror})")
            return False, None
        held = data[_DIGEST:]
        if hashlib.sha256(held).digest() != data[:_DIGEST]:
            say(f"a kept result is damaged and is made again: {path}")
            return False, None
        try:
            return True, pickle.loads(held)
        except Exception as error:  # of a class that is gone, say
            say(f"a kept result cannot be read and is made again: {path} ({error})")
            return False, None

    def put(self, parameters: dict[str, Any], result: Any) -> None:
        """Keep a result; the file appears whole or not at all.  A full disk is said, and the sweep goes on."""
        target = self.file(parameters)
        part = target.with_name(f".{secrets.token_hex(8)}.part")
        held = pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
        try:
            with part.open("xb") as file:
                file.write(hashlib.sha256(held).digest())
                file.write(held)
            os.replace(part, target)
        except OSError as error:
            if not self._full:
                say(f"results cannot be kept in {self.path}: {error.strerror}")
            self._full = True
        finally:
            part.unlink(missing_ok=True)
