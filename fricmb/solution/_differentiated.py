"""Transitions of a solution, and its derivatives."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Protocol

from fricmb._facade import facade
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._events import Event, Events
from fricmb.solution._recorded import Recorded


class LooksFor(Protocol):
    """What finds events in a run."""

    @property
    def events(self) -> tuple[Any, ...]:
        """Those asked for."""

    def found(self, sol: Any) -> list[Event]:
        """Events along the whole run."""


class Differentiated(Recorded):
    """Transitions, and derivatives of what a run found."""

    @cached_property
    def events(self) -> Events:
        """Transitions of the run, and the events that were asked for, in time order."""
        if self._events is None:
            (piece,) = self.run.pieces
            transitions, names = piece.trajectory.transitions, self.names.contacts
            if transitions.contact.max(initial=-1) >= len(names):
                names = (*names, *piece.mechanics.joint_names)
            found = Events.from_transitions(transitions, names)
            self._events = found if piece.t_end >= piece.trajectory.t[-1] else found.until(piece.t_end)
        if self._look_for is not None:
            seen = type(self)(names=self.names, run=self.run, stats=self._stats, events=self._events)
            self._events, self.asked_events = self._events.with_asked(self._look_for.found(seen)), self._look_for.events
            self._look_for = None
        return self._events

    def look_for(self, asked: LooksFor) -> None:
        """Have events beside the transitions, located when events are first read."""
        self.__dict__.pop("events", None)
        self._look_for = asked

    def sensitivity(self, signal: str, name: str) -> Floats:
        """Derivative (n_t,) of a signal with respect to a parameter or an initial value, at fixed times.

        Exact through stick and slip: transitions move with the parameter, and that is part of the derivative.

        Parameters
        ----------
        signal : str
            A degree of freedom or point ("pad.x"), its velocity ("pad.x.velocity"), a law's state ("lining.state.z").
        name : str
            One of the names that ``simulate(sensitivities=...)`` was given; after "state" also "pad.position.x",
            "pad.velocity.x", "lining.state.z" for the values that the run starts with.

        Raises
        ------
        SceneError
            If the run was made without sensitivities; UnknownNameError lists the names near.
        """
        return self.derivatives.signal(self.names, signal, name, self.record.samples)

    @property
    def monodromy(self) -> Floats:
        """Derivative of the state at the end with respect to that at the start (n_y, n_y), y = q over v over z.

        Needs ``simulate(sensitivities="state")``; at the start of a run in stick, what sticks is held together.
        """
        return self.derivatives.monodromy

    @property
    def unsafe_events(self) -> tuple[Event, ...]:
        """Transitions after which derivatives are not sound; ``sol.stats.notes`` says why.

        They are transitions that only touch their condition, releases that stuck contacts leave undetermined, and
        several independent changes at one time.  Needs ``simulate(sensitivities=...)``.
        """
        return tuple(self.events[i] for i in self.derivatives.unsafe)

    @property
    def derivatives(self) -> Derivatives:
        """All derivatives as arrays, over the times of the solution."""
        if self._derivatives is None:
            if not self._asked:
                raise SceneError(
                    "this solution has no derivatives: simulate with sensitivities=(names), or sensitivities="
                    '"state"; joined runs have none, each of their parts has its own'
                )
            self._differentiate(self._asked)
        assert self._derivatives is not None
        return self._derivatives

    @facade
    def _differentiate(self, asked: tuple[str, ...]) -> None:
        """Find derivatives by what ``simulate(sensitivities=...)`` was given, and take them."""

    def take_derivatives(self, derivatives: Derivatives) -> None:
        """Keep derivatives, those of its events with the events."""
        self._asked, self._derivatives = derivatives.asked, derivatives
        events = self.events.with_derivatives(derivatives.columns, derivatives.event_times, derivatives.transversality)
        self.__dict__["events"] = self._events = events
