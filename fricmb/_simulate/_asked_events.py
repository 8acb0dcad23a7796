"""Events that a user asks for: expressions whose sign changes are located, and those at which a run ends."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._simulate._arguments import Span
from fricmb._simulate._mechanics import SceneMechanics
from fricmb.errors import IntegrationError, SceneError, shown, unknown_name
from fricmb.integrate import Integrator, Problem, Start, Trajectory
from fricmb.scene import check_expression, expression_uses
from fricmb.solution import Event, LooksFor, Names, Solution, owner_of
from fricmb.values import Declaration, as_float, has_entries, is_plain, substitute

if TYPE_CHECKING:
    from fricmb.field import AskedEvent

#: Makes a solution of a trajectory and the times of a run, with what is looked for in it.
Finish = Callable[[Trajectory, Span, LooksFor | None], Solution]
#: Bytes of rows of the first part of a run that is looked through for its end, and growth from part to part.
_FIRST, _GROWTH = 4e6, 4.0


@dataclass(frozen=True, eq=False, kw_only=True)
class _Stated(Declaration):
    """An expression as a declaration, which checks it."""

    name: str
    value: Any

    def __post_init__(self) -> None:
        self._set("value", check_expression(self, "value", self.value, motions=True))

    def _label(self) -> str:
        return f"events: {self.name!r}"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """All that a run is asked for; ``terminal``: names of those at which it ends."""

    events: tuple[AskedEvent, ...] = ()
    terminal: tuple[str, ...] = ()

    def check(self, names: Names) -> None:
        """Whether a run holds what they read."""
        for one in self.events:
            for name in one.motions:
                if not isinstance(one.value, tuple) and name not in names.known_motions():
                    raise unknown_name(f"motion of the event {one.name!r}:", name, names.known_motions())

    def found(self, sol: Solution) -> list[Event]:
        """Events along a run."""
        return [event for one in self.events for event in one.events(sol)]

    def first_end(self, sol: Solution) -> Event | None:
        """The first event at which a run ends."""
        found = [one.first(sol) for one in self.events if one.name in self.terminal]
        return min((event for event in found if event is not None), key=lambda event: event.t, default=None)


@dataclass(frozen=True, kw_only=True)
class UpTo:
    """What is asked of a run that ends at ``end``, one of its own events."""

    asked: Asked
    end: Event

    @property
    def events(self) -> tuple[AskedEvent, ...]:
        """Those asked for."""
        return self.asked.events

    def found(self, sol: Solution) -> list[Event]:
        """Events along a run: the last one is known, since round-off may have moved it beyond the end."""
        found = [event for one in self.events if one.name not in self.asked.terminal for event in one.events(sol)]
        return [*found, self.end] if sol.t_end >= self.end.t else found


@dataclass(frozen=True, kw_only=True)
class Known:
    """Events of a run that were located while it was made."""

    events: tuple[AskedEvent, ...]
    known: tuple[Event, ...]

    def found(self, sol: Solution) -> list[Event]:
        """Those not later than its end."""
        return [event for event in self.known if event.t <= sol.t_end]


def check_events(mechanics: SceneMechanics, events: Any, terminal: Any) -> Asked:
    """The arguments of these names.

    Raises
    ------
    SceneError
        Naming the event, what was given, and what is accepted.
    """
    accepted = (
        "a dict of names and expressions in fm.t, fm.coordinate(...), fm.speed(...) and parameters, or pairs such as"
        ' ("sole.force", 2.0)'
    )
    if events is None:
        events = {}
    if not isinstance(events, Mapping) or not all(isinstance(name, str) and name for name in events):
        raise SceneError(f"events: got {shown(events)}; expected {accepted}")
    asked = _asked(mechanics, events) if events else ()
    taken = (terminal,) if isinstance(terminal, str) else terminal
    if not isinstance(taken, tuple | list | set | frozenset) or not all(isinstance(name, str) for name in taken):
        raise SceneError(f"terminal: got {shown(terminal)}; expected names out of events=")
    for name in taken:
        if name not in events:
            raise unknown_name("terminal event", name, list(events))
    found = Asked(events=asked, terminal=tuple(taken))
    if asked:
        found.check(mechanics.names)
    return found


def _asked(mechanics: SceneMechanics, events: Mapping[str, Any]) -> tuple[AskedEvent, ...]:
    """What is located; a scene for which nobody asks pays nothing: large ones have many parameters."""
    from fricmb.field import AskedEvent

    values = {name: value for name, value in mechanics.scene.parameters.items() if is_plain(value)}
    return tuple(AskedEvent(name, _expression(name, value, values)) for name, value in events.items())


def _expression(name: str, value: Any, parameters: dict[str, Any]) -> Any:
    """An expression with the values that its parameters have in the scene; or a signal and its level."""
    if isinstance(value, tuple | list):
        level = as_float(value[1]) if len(value) == 2 else np.nan
        if len(value) != 2 or not isinstance(value[0], str) or not np.isfinite(level):
            accepted = 'a signal and a number, ("sole.force", 2.0)'
            raise SceneError(f"events: {name!r}: got {shown(value)}; expected {accepted}")
        return value[0], level
    stated = substitute(_Stated(name=name, value=_difference(value)).value, parameters)
    if expression_uses(stated).constant:
        raise SceneError(
            f"events: {name!r}: got {shown(value)}, which does not change; expected an expression of motion or time"
        )
    return stated


def _difference(value: Any) -> Any:
    """Of a relation what is on its left less what is on its right; anything else as it is."""
    return value.lhs - value.rhs if getattr(value, "is_Relational", False) else value


def with_observed(observe: Any, events: Any) -> Any:
    """What is observed, and what events read: a part that only an event needs is not left out."""
    if observe is None or isinstance(observe, str) or not has_entries(observe) or not isinstance(events, Mapping):
        return observe
    read: list[str] = []
    for value in events.values():
        if isinstance(value, tuple | list):
            read += [owner_of(name) or name for name in value[:1] if isinstance(name, str)]
        else:
            read += expression_uses(_difference(value)).motions
    return [*observe, *(name for name in sorted(set(read)) if name not in observe)]


def find_end(
    asked: Asked, integrator: Integrator, problem: Problem, start: Start, span: Span,
    finish: Finish, options: Mapping[str, Any],
) -> Event | None:  # fmt: skip
    """The first event at which a run ends; None where none comes.

    The run is made part by part, each longer than the one before, until there is one: a run that ends early costs
    little, however far away its ``t_end``.
    """
    memory = _FIRST
    while start.t < span.t_end:
        more = {**options, "memory": memory} if integrator.pauses else dict(options)
        part = integrator.integrate(problem, start, span.t_end, **more)
        try:
            sol: Solution | None = finish(part, Span(t_start=start.t, t_end=float(part.ends[1]), t_eval=None), None)
        except IntegrationError as error:  # the run itself will say so, unless it ends before
            sol = error.partial
        found = None if sol is None else asked.first_end(sol)
        if found is not None or part.failure is not None or not integrator.pauses:
            return found
        start, memory = part.end, _GROWTH * memory
    return None


def cut(span: Span, t_end: float) -> Span:
    """A span that ends earlier."""
    times = span.t_eval
    if times is not None:
        times = times[times <= t_end]
        times = times if times.size else np.array([t_end])
    return Span(t_start=span.t_start, t_end=t_end, t_eval=times)
