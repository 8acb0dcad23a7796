"""Kinds of event: each is stated once, here, and its number is its place in the table.

To add a kind of event that ``radau`` and ``bdf`` locate: its row, and its number by name, before ``EVENT_ASKED`` (those
before it are counted contact by contact); a trigger, a function that falls below 0 where a step has to end, as the head
of ``implicit/events/triggers`` says; and what happens there in ``implicit/attempt_step``. What is known without a
trigger is put down where it is known, by ``run/mode_changes.record_event``. One such event a step has its space; for
more of them ask ``crowded`` in ``implicit/output/recorder`` to keep it. Nothing else lists kinds. What tells events of
one instant once (``told_once`` and ``touches`` in ``run``), counts, saves, exports or differentiates them, and the
docstring of ``Event``, read this table. ``collocation`` and ``taylor`` locate transitions in files of their own, and
put down no other kinds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class EventKind:
    """The ``name`` by which users know a kind, and what it ``says`` has happened.

    ``transition``: what a contact does changes. A kind that is no transition leaves the run as it is: it makes no pair
    with a transition, and its time has a derivative only where a user has asked for it. ``impact``: it has a row among
    ``Transitions.impacts``.
    """

    name: str
    says: str
    transition: bool = True
    impact: bool = False


TABLE = (
    EventKind(name="stick", says="slip ends"),
    EventKind(name="slip", says="stick ends"),
    EventKind(name="open", says="contact is lost"),
    EventKind(name="close", says="contact is made again"),
    EventKind(name="reversal", says="one-dimensional slip turns round without sticking"),
    EventKind(name="impact", says="a hard contact is hit", impact=True),
    EventKind(name="rest", says="bounces have ended, and the contact is held", impact=True),
    EventKind(name="event", says="an expression that was asked for changes its sign", transition=False),
)
(
    EVENT_STICK, EVENT_SLIP, EVENT_OPEN, EVENT_CLOSE, EVENT_REVERSAL, EVENT_IMPACT, EVENT_REST, EVENT_ASKED,
) = range(len(TABLE))  # fmt: skip
#: By number: names, whether each is a transition, and whether it has numbers of an impact.
EVENT_KINDS = tuple(kind.name for kind in TABLE)
IS_TRANSITION = np.array([kind.transition for kind in TABLE])
HAS_IMPACT = np.array([kind.impact for kind in TABLE])
#: Names of what happens to one contact, and is counted contact by contact.
OF_CONTACTS = tuple(kind.name for kind in TABLE[:EVENT_ASKED] if not kind.impact)
