"""Which islands are run, by which integrator, and running them one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from fricmb._simulate._arguments import Span
from fricmb._simulate._joined import JoinedRun
from fricmb._simulate._mechanics import SceneMechanics
from fricmb._simulate._members import Member
from fricmb._simulate._method import find_integrator
from fricmb.errors import SceneError
from fricmb.integrate import Integrator, Problem, Start, Tolerance, Trajectory
from fricmb.integrate.methods.free_vibration import Exact
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.chunked_run import run_kept


@dataclass(frozen=True, kw_only=True)
class Task:
    """One member, its problem for the run's span, and who runs it."""

    index: int
    member: Member
    problem: Problem
    integrator: Integrator
    why: str


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """Who runs a scene: ``name`` and ``why`` for people; ``problem`` is handed to ``integrator``."""

    mechanics: SceneMechanics
    integrator: Integrator
    problem: Problem
    name: str
    why: str
    adaptive: bool


@dataclass(frozen=True, kw_only=True)
class Islands(Integrator):
    """Runs each of several problems with its own integrator and steps; the argument ``problem`` is not looked at."""

    mechanics: SceneMechanics
    tasks: tuple[Task, ...]

    name: ClassVar[str] = "islands"
    order: ClassVar[str] = "as its parts"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    pauses: ClassVar[bool] = True

    def integrate(
        self,
        problem: Problem,
        start: Start,
        t_end: float,
        *,
        tolerance: Tolerance,
        step: float | None = None,
        t_eval: Floats | None = None,
        progress: Callable[[float], None] | None = None,
        memory: float | None = None,
    ) -> Trajectory:
        """Run every island to ``t_end``, or to where it fails (see :class:`Integrator`)."""
        runs = []
        for number, task in enumerate(self.tasks):
            place = task.member.place
            options: dict[str, Any] = {"tolerance": _share(tolerance, task), "t_eval": t_eval}
            options["step"] = None if task.integrator.adaptive else step
            if progress is not None:
                options["progress"] = _part_of(progress, start.t, t_end, number, len(self.tasks))
            mine = place.start(start)
            if memory is not None and t_eval is not None:
                # what cannot be kept whole holds its values at t_eval
                share = memory / len(self.tasks)
                run = run_kept(task.integrator, task.problem, mine, t_end, memory=share, **options)
            else:
                run = task.integrator.integrate(task.problem, mine, t_end, **options)
            runs.append((task.index, run))
        m = self.mechanics
        took = [run.instead or (task.integrator.name, "") for (_, run), task in zip(runs, self.tasks, strict=True)]
        names = [name for name, _ in took]
        return JoinedRun(runs, names, m.members, m.names, start, m.idle, rows=t_eval is None)


def _share(tolerance: Tolerance, task: Task) -> Tolerance:
    """The tolerance of a task."""
    if tolerance.atol_q is None or tolerance.atol_v is None:
        return tolerance
    dofs = task.member.place.dofs
    return replace(tolerance, atol_q=tolerance.atol_q[dofs], atol_v=tolerance.atol_v[dofs])


def _part_of(progress: Callable[[float], None], t0: float, t1: float, k: int, n: int) -> Callable[[float], None]:
    """Progress of one of n runs as that of all."""
    return lambda t: progress(t0 + ((t - t0) + k * (t1 - t0)) / n)


def find_runs(mechanics: SceneMechanics, method: Any, start: Start, span: Span, rtol: float) -> Chosen:
    """What is run, and by whom: islands on their own where the method takes each of them, else all as one.

    Raises
    ------
    SceneError
        For a method that is none, or refuses the scene.
    """
    if mechanics.whole is None:
        tasks = _tasks(mechanics, method, start, span, rtol)
        if tasks:
            names = tuple(dict.fromkeys(task.integrator.name for task in tasks))
            chief = max(tasks, key=lambda task: not isinstance(task.integrator, Exact)).integrator
            return Chosen(
                mechanics=mechanics, integrator=Islands(mechanics=mechanics, tasks=tasks), problem=tasks[0].problem,
                name=", ".join(names), why=_reasons(tasks), adaptive=chief.adaptive,
            )  # fmt: skip
        mechanics = mechanics.as_one()
    system = mechanics.members[0].system
    problem = system.problem_for(span.t_start, span.t_end)
    integrator, why = find_integrator(method, problem, rtol)
    return Chosen(
        mechanics=mechanics, integrator=integrator, problem=problem, name=integrator.name, why=why,
        adaptive=integrator.adaptive,
    )  # fmt: skip


def _tasks(mechanics: SceneMechanics, method: Any, start: Start, span: Span, rtol: float) -> tuple[Task, ...]:
    """A task for each island that does not rest; none where an island is refused, or all rest."""
    tasks = []
    for index in np.flatnonzero(~mechanics.rest.members(start)).tolist():
        member = mechanics.members[index]
        problem = member.system.problem_for(span.t_start, span.t_end)
        try:
            integrator, why = find_integrator(method, problem, rtol)
        except SceneError:
            exact = Exact()
            if not isinstance(method, str | Integrator) or exact.refuses(problem) is not None:
                return ()  # asked again for all together, which says what is wrong
            integrator, why = exact, "free vibration, which the given method does not take: closed form"
        tasks.append(Task(index=index, member=member, problem=problem, integrator=integrator, why=why))
    return tuple(tasks)


def _reasons(tasks: Sequence[Task]) -> str:
    """Why, once for each reason, with the number of islands where there are several."""
    count: dict[str, int] = {}
    for task in tasks:
        key = f"{task.integrator.name}: {task.why}"
        count[key] = count.get(key, 0) + 1
    if len(count) == 1:
        ((_, number),) = count.items()
        return tasks[0].why + (f" ({number} islands)" if number > 1 else "")
    return "; ".join(key + (f" ({number} islands)" if number > 1 else "") for key, number in count.items())
