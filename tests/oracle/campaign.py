"""Scenes one after the other, each by every method, in one process or in several; what was done is not done again."""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import pickle
import queue
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from . import driven, drives, feet, groups, impacts, machines, units
from .drawn import Drawn
from .inputs import Shaken
from .inputs import case_of as inputs_case
from .judge import Case, Truth, Verdict, Worker, end_with_parent, judge
from .mechanisms import Chain
from .mechanisms import case_of as chain_case
from .problem import OracleError
from .random_scenes import generate
from .shrink import BAD, shrunk
from .space import Bodies
from .space import case_of as space_case
from .spec import Spec, case_of
from .table import LAWS, SITUATIONS
from .table import case as cell

#: What makes both forms of a scene that was drawn as numbers.
MAKERS = {
    **feet.MAKERS, **driven.MAKERS, **drives.MAKERS, **groups.MAKERS, **units.MAKERS, **impacts.MAKERS,
    **machines.MAKERS,
}  # fmt: skip
#: How long the oracle itself may take for a scene; most take one or two.
SECONDS = 40.0

Found = tuple[str, dict[str, Any], str, list[tuple[str, Verdict, dict[str, Any]]]]


def scenes(options: argparse.Namespace) -> Iterator[tuple[str, dict[str, Any], Any]]:
    """Kind, where it comes from, and the scene as data (None: a cell of the table)."""
    if options.table:
        for law in options.laws.split(",") if options.laws else LAWS:
            for situation in SITUATIONS:
                yield "table", {"law": law, "situation": situation}, None
        return
    kinds = options.kinds.split(",")
    for i in range(options.scenes):
        turn, kind = i % len(kinds), kinds[i % len(kinds)]
        # a kind that is named several times gets as many seeds in each turn
        seed = options.seed + i // len(kinds) * kinds.count(kind) + kinds[:turn].count(kind)
        yield kind, {"kind": kind, "seed": seed}, generate(kind, seed)


def make(where: dict[str, Any], spec: Any) -> Any:
    """The scene in both forms."""
    if spec is None:
        return cell(where["law"], where["situation"])
    if isinstance(spec, Drawn):
        return MAKERS[spec.maker](spec.n)
    if isinstance(spec, Shaken):
        return inputs_case(spec)
    if isinstance(spec, Bodies):
        return space_case(spec)
    return chain_case(spec) if isinstance(spec, Chain) else case_of(spec)


def begun(path: Path | None) -> list[Found]:
    """What an earlier part of the campaign has written down."""
    if path is None or not path.exists():
        return []
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    return [
        (line["kind"], line["where"], line["outcome"], [(m, Verdict(**v), extra) for m, v, extra in line["verdicts"]])
        for line in lines
    ]


def noted(path: Path | None, found: Found) -> None:
    """Write down what was found of one scene."""
    if path is not None:
        kind, where, outcome, verdicts = found
        plain = [(method, asdict(verdict), extra) for method, verdict, extra in verdicts]
        with path.open("a") as file:
            file.write(json.dumps({"kind": kind, "where": where, "outcome": outcome, "verdicts": plain}) + "\n")


#: Modules whose text decides what the oracle says of given numbers.
DECIDING = (
    "problem", "laws", "loads", "instant", "motion", "slow", "turning", "run", "struck", "hits", "bounces",
    "struck_judge",
)  # fmt: skip


def said(case: Case, spec: Any, folder: Path | None) -> Truth:
    """What the oracle says of the scene; kept in ``folder``, as it says the same whatever becomes of the engine."""
    if folder is None or spec is None:
        return case.truth()
    home = Path(__file__).parent
    key = hashlib.sha256(json.dumps(spec.data(), sort_keys=True).encode())
    for name in DECIDING:
        key.update((home / f"{name}.py").read_bytes())
    path = folder / f"{spec.kind}-{key.hexdigest()[:24]}.pickle"
    if path.exists():
        return replace(pickle.loads(path.read_bytes()), case=case)
    true = case.truth()
    folder.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps(replace(true, case=None)))  # type: ignore[arg-type]
    return true


def gathered(options: argparse.Namespace, start: float) -> Iterator[Found]:
    """What several processes find, each of them every so many scenes."""
    context = multiprocessing.get_context("spawn")
    done: Any = context.Queue()
    crew = [context.Process(target=part, args=(options, k, start, done)) for k in range(options.processes)]
    for process in crew:
        process.start()
    while any(process.is_alive() for process in crew) or not done.empty():
        try:
            yield done.get(timeout=1.0)
        except queue.Empty:
            continue


def part(options: argparse.Namespace, number: int, start: float, done: Any) -> None:
    """What one of several processes does."""
    end_with_parent()
    for found in tried(options, number, start):
        done.put(found)


def tried(options: argparse.Namespace, number: int, start: float) -> Iterator[Found]:
    """Every so many scenes, from ``number`` on: kind, where from, judged, marginal or why not decided, verdicts."""
    worker, kinds = Worker(options.limit), len(options.kinds.split(","))
    done = {json.dumps(where) for _, where, _, _ in begun(options.log)}
    for i, (kind, where, spec) in enumerate(scenes(options)):
        # shifted by one from seed to seed: each process gets scenes of every kind, whatever their number
        if (i + i // kinds) % options.processes != number:
            continue
        if json.dumps(where) in done:
            continue
        if (time.monotonic() - start) / 60.0 > options.minutes:
            break
        try:
            with limited(SECONDS):
                true = said(make(where, spec), spec, options.truths)
        except (OracleError, ArithmeticError, ValueError) as error:  # whatever it fails at, the next scene is tried
            yield kind, where, f"{type(error).__name__}: {error}", []
            continue
        if true.marginal or not options.methods:
            yield kind, where, "marginal" if true.marginal else "judged", []
        else:
            yield kind, where, "judged", list(runs(true, spec, worker, options))
    worker.stop()


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """An error where what is inside takes longer (of this process's processor time)."""

    def too_long(number: int, frame: Any) -> None:
        raise OracleError(f"the oracle takes longer than {seconds:g} s")

    before = signal.signal(signal.SIGPROF, too_long)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def runs(true: Truth, spec: Any, worker: Worker, options: argparse.Namespace) -> Iterator[tuple[str, Verdict, Any]]:
    """Every method on one scene; what ``auto`` has done alone is not done again under its name."""
    known: dict[str, Verdict] = {}
    for method in options.methods.split(","):
        verdict = known[method] if method in known else judge(true, method, options.rtol, worker)
        if method == "auto" and verdict.method:
            known[verdict.method] = verdict
        extra = {}
        if options.shrink and verdict.kind in BAD and isinstance(spec, Spec):
            extra["smallest"] = shrunk(spec, method, options.rtol, worker).data()
        yield method, verdict, extra
