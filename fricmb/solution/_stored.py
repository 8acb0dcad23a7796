"""The run behind a solution as it stands in a file: plain data, opened when the scene or the dense output is needed."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from fricmb._facade import WORDS, find
from fricmb.errors import FricmbError
from fricmb.integrate import Trajectory
from fricmb.solution._data import Reader, Writer
from fricmb.solution._formulas import NotStored
from fricmb.solution._kinds import Kinds
from fricmb.solution._run import ROUND_OFF, Mechanics, Origin, Piece, Run

#: What makes the mechanics of a scene again, by the word that a file has for it.
_builders: dict[str, tuple[Callable[..., Mechanics], type]] = {}
_Build = TypeVar("_Build", bound=Callable[..., Any])


def builder(word: str, kind: type) -> Callable[[_Build], _Build]:
    """Let files call a function that makes mechanics of scenes (of that kind) by this word."""

    def register(build: _Build) -> _Build:
        _builders[word] = build, kind
        return build

    return register


class Stored:
    """A run in a file.

    Parameters
    ----------
    source : str
        Name of the file, for messages.
    text : str
        JSON of the run; "" where there is none.
    arrays : dict of str to array
        Flat arrays by type.
    span : (float, float)
        Ends of the run.
    missing : str
        Why there is no run, where there is none.
    laws : classes, dict or "import"
        As :meth:`Solution.load` takes them.
    """

    def __init__(
        self, source: str, text: str, arrays: Mapping[str, Any], span: tuple[float, float], *, missing: str, laws: Any
    ) -> None:
        self.source, self.text, self.arrays, self.span = source, text, dict(arrays), span
        self.missing, self.laws = missing, laws

    def open(self) -> Run:
        """The run; FricmbError where it is not there or cannot be made."""
        if self.missing:
            raise FricmbError(f"{self.source} holds no scene and no dense output: {self.missing}")
        try:
            return self._run(json.loads(self.text))
        except FricmbError as error:
            raise FricmbError(f"{self.source}, entry 'run': {error}") from error
        except (ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError, OverflowError) as error:
            raise FricmbError(f"{self.source}, entry 'run' is damaged: {error}") from error

    def _run(self, held: Any) -> Run:
        known = Kinds(self.laws, held["sources"])
        reader = Reader(held["kinds"], held["objects"], self.arrays, known)
        pieces = []
        for one in held["pieces"]:
            trajectory = reader.read(one["trajectory"])
            if not isinstance(trajectory, Trajectory):
                raise ValueError("a piece has no run")
            scene, options = reader.read(one["scene"]), reader.read(one["options"])
            build, kind = _builder(one["build"])
            if not isinstance(scene, kind) or not isinstance(options, dict):
                raise ValueError(f"a piece was run with {type(scene).__name__} and {type(options).__name__}")
            origin = Origin(scene=scene, build=build, options=options)
            t_start, t_end = float(one["t_start"]), float(one["t_end"])
            pieces.append(Piece.again(trajectory, origin, t_start, t_end, self.source))
        ends = [t for piece in pieces for t in (piece.t_start, piece.t_end)]
        margin = ROUND_OFF * float(np.abs(self.span).max())
        if not pieces or (ends[0], ends[-1]) != self.span or not np.all(np.diff(ends) >= -margin):
            raise ValueError(f"the pieces go through {ends}, the run from {self.span[0]} to {self.span[1]}")
        return Run(tuple(pieces))


def store(run: Run) -> tuple[str, dict[str, Any]]:
    """JSON and flat arrays of a run; raises NotStored for what is no data."""
    writer = Writer()
    pieces = []
    for piece in run.pieces:
        words = [word for word, (build, _) in _builders.items() if build is piece.origin.build]
        if not words:
            raise NotStored(f"nothing is known of {piece.origin.build!r}, which made its mechanics")
        pieces.append(
            {
                "build": words[0],
                "scene": writer.write(piece.origin.scene),
                "options": writer.write(piece.origin.options),
                "trajectory": writer.write(piece._trajectory),
                "t_start": piece.t_start,
                "t_end": piece.t_end,
            }
        )
    held = {"pieces": pieces, "kinds": writer.kinds, "objects": writer.objects, "sources": writer.sources}
    return json.dumps(held, allow_nan=False, separators=(",", ":")), writer.arrays()


def _builder(word: Any) -> tuple[Callable[..., Mechanics], type]:
    if word == "scene" and word not in _builders:
        find(WORDS[word])  # makes itself known where it is imported
    if word not in _builders:
        raise ValueError(f"the mechanics {word!r} are not known here")
    return _builders[word]
