"""Transitions as a sequence of named events."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from textwrap import fill
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, unknown_name
from fricmb.integrate import EVENT_KINDS, Transitions
from fricmb.integrate.event_kinds import EVENT_ASKED, HAS_IMPACT, IS_TRANSITION, TABLE
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.trajectory import IMPACT_COLUMNS

#: The kind of an event that a user has asked for.
ASKED = EVENT_KINDS[EVENT_ASKED]


@dataclass(frozen=True)
class Event:
    """A transition of a contact, or a time at which an expression of ``simulate(events=...)`` changes its sign.

    Attributes
    ----------
    t : float
    name : str
        Of the contact, or of the expression.
    kind : str
        {kinds}.

    Of an impact also :attr:`impulse`, :attr:`tangential_impulse`, :attr:`approach`, :attr:`loss`, :attr:`others`; of a
    rest :attr:`left` and :attr:`bound`; of both :attr:`side`.

    Of a run with ``sensitivities`` also :meth:`sensitivity` and :attr:`transversality`.
    """

    t: float
    name: str
    kind: str
    _dt: TimeDerivatives | None = field(default=None, compare=False, repr=False)
    _impact: tuple[float, ...] | None = field(default=None, compare=False, repr=False)

    @property
    def impulse(self) -> float:
        """Of an impact: the impulse along the normal, >= 0."""
        return self._of_impact("normal")

    @property
    def tangential_impulse(self) -> float:
        """Of an impact: that of friction, on the contact's first end along its direction of slip."""
        return self._of_impact("tangential")

    @property
    def approach(self) -> float:
        """Of an impact, or the last one before a rest: the speed with which the distance closed, >= 0."""
        return self._of_impact("approach")

    @property
    def loss(self) -> float:
        """Of an impact: the energy that it took."""
        return self._of_impact("loss")

    @property
    def others(self) -> int:
        """Of an impact: how many other contacts took an impulse at the same instant."""
        return int(self._of_impact("others"))

    @property
    def left(self) -> float:
        """Of a rest: for how long before it the contact is held in the run, while bounces would still fade."""
        return self._of_impact("left")

    @property
    def bound(self) -> float:
        """Of a rest: bound of the error of its time, by bounces left out, round-off, and rtol of the time so far."""
        return self._of_impact("bound")

    @property
    def side(self) -> str:
        """Of an impact or rest of a part with two ends: "lower" or "upper"; else ""."""
        return {-1: "lower", 0: "", 1: "upper"}[int(self._of_impact("side"))]

    def _of_impact(self, column: str) -> float:
        if self._impact is None:
            raise SceneError(f"this event is a {self.kind!r}; only those of kind 'impact' and 'rest' have that")
        return float(self._impact[IMPACT_COLUMNS.index(column)])

    @property
    def contact(self) -> str:
        """Name of the contact; "" for an expression."""
        return "" if self.kind == ASKED else self.name

    def sensitivity(self, name: str) -> float:
        """Derivative of the time of the event with respect to a parameter or initial value.

        Raises
        ------
        UnknownNameError
            For a name that ``simulate(sensitivities=...)`` was not given; lists those near.
        """
        return self._derivatives().by(name)

    @property
    def transversality(self) -> float:
        """How surely the event happens: the rate at which its event function crosses 0, in units of its own.

        Of slip that ends or turns round, the rate of the slip velocity over what friction at its limit makes of it; of
        a release, the rate of sticking friction over its limit, times the time since the event before; of a normal
        force that vanishes, the rate over the sum of its parts.  Near 0 the event only touches its condition, and there
        is no derivative; inf where a time that is given sets it off.
        """
        return self._derivatives().transversality

    def _derivatives(self) -> TimeDerivatives:
        if self._dt is None:
            raise SceneError("events of this run have no derivatives: simulate with sensitivities=(names)")
        return self._dt


_KINDS = ", ".join(f'"{kind.name}" ({kind.says})' for kind in TABLE)
Event.__doc__ = str(Event.__doc__).format(kinds=fill(_KINDS, 111).replace("\n", "\n        "))


@dataclass(frozen=True, kw_only=True)
class TimeDerivatives:
    """Derivatives of an event's time: by ``columns`` (n,), and its transversality."""

    columns: tuple[str, ...]
    derivatives: Floats
    transversality: float

    def by(self, name: str) -> float:
        """Derivative with respect to one of the columns."""
        if name not in self.columns:
            raise unknown_name("sensitivity", name, self.columns)
        return float(self.derivatives[self.columns.index(name)])


class Events(Sequence[Event]):
    """The transitions of a run, and the events that were asked for, in time order.

    A sequence of :class:`Event`; ``events.t`` are the times as an array, ``events.of(kind="stick", contact="lining")``
    a part of them.
    """

    def __init__(self, events: Iterable[Event]) -> None:
        held = list(events)
        self._names = tuple(dict.fromkeys(event.name for event in held))
        place = {name: i for i, name in enumerate(self._names)}
        self._t = np.array([event.t for event in held], dtype=float)
        self._name = np.array([place[event.name] for event in held], dtype=np.int64)
        self._kind = np.array([EVENT_KINDS.index(event.kind) for event in held], dtype=np.int64)
        dt = [event._dt for event in held]
        self._dt = dt if any(one is not None for one in dt) else None
        rows = [event._impact for event in held if event._impact is not None]
        self._impacts = np.array(rows, dtype=float).reshape(-1, len(IMPACT_COLUMNS))

    @classmethod
    def from_transitions(cls, transitions: Transitions, contacts: tuple[str, ...]) -> Events:
        """Name the transitions that an integrator recorded; objects are made when they are looked at.

        ``contacts``: names of contacts, and behind them of joints; those of both ends of a part are the same.
        """
        place = {name: i for i, name in enumerate(dict.fromkeys(contacts))}
        contact = np.array([place[name] for name in contacts], dtype=np.int64)[transitions.contact]
        return cls._of(tuple(place), transitions.t, contact, transitions.kind, impacts=transitions.impacts)

    @classmethod
    def _of(
        cls, names: tuple[str, ...], t: Floats, name: Ints, kind: Ints,
        dt: list[TimeDerivatives | None] | None = None, impacts: Floats | None = None,
    ) -> Events:  # fmt: skip
        events = cls.__new__(cls)
        events._names, events._t, events._name, events._kind, events._dt = names, t, name, kind, dt
        events._impacts = np.zeros((0, len(IMPACT_COLUMNS))) if impacts is None else impacts
        return events

    @property
    def impacts(self) -> Floats:
        """Numbers of the impacts and rests among them, in order (n_i, 11)."""
        return self._impacts

    def with_impacts(self, impacts: Floats) -> Events:
        """The same events with the numbers of their impacts and rests (n_i, 11)."""
        return self._of(self._names, self._t, self._name, self._kind, self._dt, impacts)

    def _row_of_impact(self) -> Ints:
        """Row of each event among the impacts (n_events,), -1 for others."""
        mine = HAS_IMPACT[self._kind]
        return np.where(mine & (len(self._impacts) > 0), np.cumsum(mine) - 1, -1)

    def _part(self, chosen: Any) -> Events:
        dt = None
        if self._dt is not None:
            dt = [self._dt[i] for i in np.arange(len(self))[chosen].tolist()]
        rows = self._row_of_impact()[chosen]
        impacts = self._impacts[rows[rows >= 0]]
        return self._of(self._names, self._t[chosen], self._name[chosen], self._kind[chosen], dt, impacts)

    def with_derivatives(self, columns: tuple[str, ...], dt: Floats, transversality: Floats) -> Events:
        """The same events with the derivatives of their times (n_events, n_columns)."""
        held = [
            TimeDerivatives(columns=columns, derivatives=row, transversality=rate)
            for row, rate in zip(dt, transversality.tolist(), strict=True)
        ]
        return self._of(self._names, self._t, self._name, self._kind, list(held), self._impacts)

    @property
    def t(self) -> Floats:
        """Times (n_events,)."""
        return self._t.copy()

    def of(self, *, kind: str | None = None, contact: str | None = None, name: str | None = None) -> Events:
        """Events of one kind, of one contact or of one expression, and what is asked of them together.

        Parameters
        ----------
        kind : str, optional
            As in :class:`Event`.
        contact, name : str, optional
            Of a contact; of a contact or an expression.
        """
        if kind is not None and kind not in EVENT_KINDS:
            raise unknown_name("kind of event", kind, EVENT_KINDS)
        mine = np.ones(len(self), dtype=bool)
        if kind is not None:
            mine &= self._kind == EVENT_KINDS.index(kind)
        if contact is not None:
            mine &= (self._name == self._place(contact)) & (self._kind != EVENT_ASKED)
        if name is not None:
            mine &= self._name == self._place(name)
        return self._part(mine)

    def _place(self, name: str) -> int:
        """Number of a name, -1 for one without events."""
        return self._names.index(name) if name in self._names else -1

    @property
    def transitions(self) -> Events:
        """The transitions of contacts alone."""
        mine = self.is_transition
        return self if mine.all() else self._part(mine)

    @property
    def is_transition(self) -> NDArray[np.bool_]:
        """Whether at each event (n_events,) what a contact does changes, and not only what has been asked for."""
        found: NDArray[np.bool_] = IS_TRANSITION[self._kind]
        return found

    def with_asked(self, asked: Iterable[Event]) -> Events:
        """These and what was asked for, in time order; at one time transitions come first."""
        return Events(sorted([*self, *asked], key=lambda event: event.t))

    def until(self, t: float) -> Events:
        """Events not later than t."""
        return self._part(self._t <= t)

    def __len__(self) -> int:
        return len(self._t)

    @overload
    def __getitem__(self, index: int) -> Event: ...
    @overload
    def __getitem__(self, index: slice) -> Events: ...
    def __getitem__(self, index: int | slice) -> Event | Events:
        if isinstance(index, slice):
            return self._part(index)
        dt = None if self._dt is None else self._dt[index]
        row, name = int(self._row_of_impact()[index]), self._names[self._name[index]]
        impact = None if row < 0 else tuple(self._impacts[row].tolist())
        return Event(float(self._t[index]), name, EVENT_KINDS[self._kind[index]], dt, impact)

    def __iter__(self) -> Iterator[Event]:
        dt = [None] * len(self) if self._dt is None else self._dt
        impacts = [tuple(row) for row in self._impacts.tolist()]
        held = [None if row < 0 else impacts[row] for row in self._row_of_impact().tolist()]
        columns = zip(self._t.tolist(), self._name.tolist(), self._kind.tolist(), dt, held, strict=True)
        return (
            Event(t, self._names[name], EVENT_KINDS[kind], one, impact) for t, name, kind, one, impact in columns
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Events) and len(self) == len(other) and all(map(operator.eq, self, other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        if not len(self):
            return "<no events>"
        counts = np.bincount(self._kind, minlength=len(EVENT_KINDS)).tolist()
        shown = ", ".join(f"{n} {kind}" for kind, n in zip(EVENT_KINDS, counts, strict=True) if n)
        return f"<{len(self)} events: {shown}>"
