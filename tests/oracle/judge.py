"""The error of a run of fricmb, over its tolerance and over how much the scene magnifies any error."""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numba.core import event as numba_event

import fricmb as fm

from .problem import Motion, OracleError, Problem, Transition
from .run import solve

#: Perturbation of starts and loads that tells the growth of errors.
DELTA = 1e-6
#: Error over rtol and growth above which a run is wrong.
BAR = 100.0
#: Tolerance of the oracle's own steps.
RTOL = 1e-10
#: Growth beyond which a scene says nothing at these tolerances.
UNRULY = 1e4


@dataclass(frozen=True, kw_only=True)
class Case:
    """One scene, twice: as fricmb has it and as numbers; ``signals`` are the names of the oracle's coordinates."""

    name: str
    scene: Any
    problem: Problem
    signals: tuple[str, ...]
    seen: Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None
    """Positions and velocities of the signals from time and those of the oracle, where these are others."""
    length: float = 1.0
    time: float = 1.0
    """The oracle's units in those of the scene."""
    alike: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Contacts of the scene that one of the oracle stands for."""
    silent: frozenset[str] = frozenset()
    """Contacts next to without friction: when their slip turns round is nothing that a run looks for."""

    def truth(self) -> Truth:
        """What the oracle says of it."""
        return truth(self)


@dataclass
class Truth:
    """What the oracle says of a case."""

    case: Case
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    growth: float
    events: list[Any]
    marginal: str = ""
    scales: tuple[np.ndarray, np.ndarray] = field(default_factory=lambda: (np.ones(1), np.ones(1)))
    hangs: dict[float, bool] = field(default_factory=dict)
    """Whether transitions hang on changes of that size, as far as that has been asked."""

    def compared(self, found: Outcome, rtol: float) -> Verdict:
        """What a run is worth."""
        return compare(self, found, rtol)


@dataclass
class Verdict:
    """``kind``: right, wrong, noted (wrong, and the run says so), refused, stopped, late, crashed, marginal."""

    kind: str
    ratio: float = 0.0
    wrong_transitions: int = 0
    why: str = ""
    method: str = ""
    """Who did the run."""


@dataclass
class Outcome:
    """A run as plain numbers: done, refused, stopped or late, with notes or the reason."""

    kind: str
    why: str = ""
    method: str = ""
    q: np.ndarray | None = None
    v: np.ndarray | None = None
    events: list[tuple[str, str]] = field(default_factory=list)
    impacts: list[tuple[str, float]] = field(default_factory=list)
    """Surface and time; of rests likewise."""
    approach: list[float] = field(default_factory=list)
    rests: list[tuple[str, float]] = field(default_factory=list)


class Worker:
    """A process of its own for runs that might not end.

    It is ended after ``limit`` seconds of its processor (where that is known, else of the clock), and begun again.
    What it compiles, or loads of what was compiled, does not count.
    """

    def __init__(self, limit: float = 20.0) -> None:
        self.limit = limit
        self.process: Any = None
        self.compiling: Any = None

    def ask(self, *arguments: Any) -> Outcome:
        """As :func:`attempt`; "late" where it took too long."""
        if self.process is None:
            context = multiprocessing.get_context("spawn")
            self.pipe, other = context.Pipe()
            self.compiling = context.Array("d", 2, lock=False)  # loading the package counts likewise
            self.process = context.Process(target=serve, args=(other, self.compiling), daemon=True)
            self.process.start()
        self.pipe.send(arguments)
        before = self.spent()
        while not self.pipe.poll(0.2) and self.spent() - before < self.limit and self.process.is_alive():
            pass
        if not self.process.is_alive() and not self.pipe.poll(0.0):
            self.stop()
            return Outcome("crashed", "the process died")
        if self.pipe.poll(0.0):
            try:
                outcome = self.pipe.recv()
            except EOFError:
                self.stop()
                return Outcome("crashed", "the process died")
            if isinstance(outcome, str):
                return Outcome("crashed", outcome)
            return outcome
        self.stop()
        return Outcome("late", f"not done within {self.limit:g} s")

    def spent(self) -> float:
        """Seconds of the processor that the process has used, but for those that went into compiling."""
        stat = Path(f"/proc/{self.process.pid}/stat")
        if not stat.exists():
            return time.monotonic()
        user, system = stat.read_text().rpartition(")")[2].split()[11:13]
        used = (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
        done, since = self.compiling
        return (used if since < 0.0 else since) - done

    def stop(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.process = None


class CompileClock(numba_event.Listener):
    """Tells another process of seconds spent loading and compiling.

    ``told`` (2,): seconds that are over, and since when it has been at it (or -1).
    """

    def __init__(self, told: Any) -> None:
        self.told = told
        self.depth = 1
        self.on_end(None)

    def on_start(self, event: Any) -> None:
        """The outermost of compilations begins."""
        if self.depth == 0:
            self.told[1] = time.process_time()
        self.depth += 1

    def on_end(self, event: Any) -> None:
        """It is over."""
        self.depth -= 1
        if self.depth == 0:
            self.told[0] += time.process_time() - self.told[1]
            self.told[1] = -1.0


def end_with_parent() -> None:
    """This process ends when the one that began it does, however that happens: killed, it could not tell us."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=lambda: (parent.join(), os._exit(1)), daemon=True).start()


def serve(pipe: Any, told: Any) -> None:
    """What the process does; ``told`` see :class:`CompileClock`."""
    end_with_parent()
    numba_event.register("numba:compiler_lock", CompileClock(told))
    while True:
        try:
            arguments = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(attempt(*arguments))
        except Exception as error:  # whatever it is, the one who asked hears of it
            pipe.send(f"{type(error).__name__}: {error}")


def truth(case: Case, n: int = 97) -> Truth:
    """The oracle's motion, and the growth of errors from a second one that starts and is loaded a little otherwise."""
    p = case.problem
    t = p.t_end * (np.arange(n) + 0.618) / n
    found = solve(p, RTOL)
    q, v = seen(case, t, found(t))
    scales = (scale_of(q, p.scale), scale_of(v, p.scale))
    other = solve(perturbed(p), 10.0 * RTOL)
    near = seen(case, t, other(t))
    off = max(np.abs((near[0] - q) / scales[0]).max(), np.abs((near[1] - v) / scales[1]).max())
    growth = max(1.0, off / DELTA)
    marginal = ""
    if found.ambiguous:
        marginal = "more than one consistent set of modes"
    elif sequence(told(case, found)) != sequence(told(case, other)):
        marginal = "transitions hang on the sixth digit"
    elif growth > UNRULY:
        marginal = f"errors grow {growth:.0e} times"
    return Truth(case, t, q, v, growth, told(case, found), marginal, scales)


def told(case: Case, motion: Motion) -> list[Transition]:
    """Transitions by the names that contacts have in the scene."""
    return [
        replace(event, contact=name)
        for event in motion.events
        for name in case.alike.get(event.contact, (event.contact,))
        if name not in case.silent
    ]


def seen(case: Case, t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities of the case's signals."""
    d = case.problem.q.size
    return (y[:d], y[d : 2 * d]) if case.seen is None else case.seen(t, y[:d], y[d : 2 * d])


def scale_of(signal: np.ndarray, speed: float) -> np.ndarray:
    """Largest values, a column; what never moves is measured by the scene's scale."""
    largest = np.abs(signal).max(axis=1, keepdims=True)
    return np.where(largest > 1e-6 * speed, largest, speed)


def perturbed(p: Problem, delta: float = DELTA) -> Problem:
    """The same from a start and under loads changed in the sixth digit."""
    signs = np.where(np.arange(p.q.size) % 3 == 1, -1.0, 1.0)

    def more(N: Any) -> Any:
        return lambda t, q, v: N(t, q, v) * (1.0 + delta)

    contacts = tuple(replace(c, N=more(c.N)) for c in p.contacts)
    moved = signs * p.scale * np.clip(np.abs(p.q), 1e-2, 1.0)
    return replace(p, q=p.q + delta * moved, contacts=contacts)


def sequence(events: Any) -> dict[str, list[str]]:
    """Kinds by contact."""
    out: dict[str, list[str]] = {}
    for event in events:
        out.setdefault(event.contact, []).append(event.kind)
    return out


def attempt(scene: Any, method: str, rtol: float, t: np.ndarray, t_end: float, signals: tuple[str, ...]) -> Outcome:
    """One run of fricmb, as plain numbers."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sol = fm.simulate(scene, t_end=t_end, rtol=rtol, method=method, t_eval=t)
    except fm.SceneError as error:
        if not str(error).startswith("method:"):
            raise
        return Outcome("refused", str(error))
    except fm.IntegrationError as error:
        return Outcome("stopped", str(error))
    hits, rests = (list(sol.events.of(kind=kind)) for kind in ("impact", "rest"))
    return Outcome(
        "done", "; ".join(sol.stats.notes), sol.stats.method, np.array([sol[name] for name in signals]),
        np.array([sol.velocity(name) for name in signals]), [(e.contact, e.kind) for e in sol.events],
        [(surface(e), float(e.t)) for e in hits], [float(e.approach) for e in hits],
        [(surface(e), float(e.t)) for e in rests],
    )  # fmt: skip


def surface(event: Any) -> str:
    """Which one is hit, of a part with two sides as well."""
    return f"{event.contact}.{event.side}" if event.side else str(event.contact)


def judge(true: Truth, method: str, rtol: float = 1e-6, worker: Worker | None = None) -> Verdict:
    """What one method makes of it at ``rtol``; with a worker, within its limit of time."""
    case = true.case
    times = case.time * true.t, case.time * case.problem.t_end
    asked = (case.scene, method, rtol, *times, case.signals)
    outcome = attempt(*asked) if worker is None else worker.ask(*asked)
    if outcome.kind != "done":
        return Verdict(outcome.kind, why=outcome.why)
    return true.compared(outcome, rtol)


def compare(true: Truth, found: Outcome, rtol: float) -> Verdict:
    """Errors of positions and velocities and the number of wrong transitions of a run."""
    assert found.q is not None
    assert found.v is not None
    length, speed = true.case.length, true.case.length / true.case.time
    off = max(
        np.abs((found.q / length - true.q) / true.scales[0]).max(),
        np.abs((found.v / speed - true.v) / true.scales[1]).max(),
    )
    ratio = float(off / (rtol * true.growth))
    heard = [(contact, kind) for contact, kind in found.events if contact not in true.case.silent]
    wrong = wrong_transitions([(e.contact, e.kind) for e in true.events], heard)
    if ratio <= BAR and wrong == 0:
        return Verdict("right", ratio, method=found.method)
    why = f"{found.method}: error {off:.1e}, growth {true.growth:.1e}; {found.why}"
    if rtol > DELTA and uncertain(true, rtol):
        return Verdict("marginal", ratio, why=f"transitions hang on changes of {rtol:g}", method=found.method)
    return Verdict("noted" if found.why else "wrong", ratio, wrong, why, found.method)


def uncertain(true: Truth, delta: float) -> bool:
    """Whether starts and loads changed by ``delta``, to either side, lead to other transitions."""
    if delta not in true.hangs:
        p, expected = true.case.problem, sequence(true.events)
        try:
            true.hangs[delta] = any(
                sequence(told(true.case, solve(perturbed(p, change), 10.0 * RTOL))) != expected
                for change in (delta, -delta)
            )
        except OracleError:
            true.hangs[delta] = True
    return true.hangs[delta]


def wrong_transitions(true: Any, found: Any) -> int:
    """How many transitions are too many or missing, kind by kind and contact by contact."""
    a, b = Counter(true), Counter(found)
    return sum(((a - b) + (b - a)).values())
