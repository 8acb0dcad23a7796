"""Kinds of event are stated once, and what is no transition comes between no two of them."""

from types import SimpleNamespace

import numpy as np
import pytest

from fricmb.integrate import event_kinds
from fricmb.integrate.event_kinds import (
    EVENT_ASKED,
    EVENT_KINDS,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    TABLE,
)
from fricmb.integrate.run.mode_changes import record_event
from fricmb.integrate.run.told_once import told_once
from fricmb.integrate.trajectory import Transitions
from fricmb.solution import Event


def test_numbers_stand_at_the_rows_of_their_names():
    for name, number in vars(event_kinds).items():
        if name.startswith("EVENT_") and isinstance(number, int):
            assert EVENT_KINDS[number] == ("event" if name == "EVENT_ASKED" else name.removeprefix("EVENT_").lower())


def test_users_are_told_of_each():
    said = " ".join(Event.__doc__.split())
    assert all(f'"{kind.name}" ({kind.says})' in said for kind in TABLE)


def test_what_is_no_transition_comes_between_no_two():
    """It stays where two transitions at one instant go."""
    t = np.array([3.0, 3.0, 3.0, 7.0])
    kind = np.array([EVENT_REVERSAL, EVENT_ASKED, EVENT_STICK, EVENT_SLIP])
    left = told_once(Transitions(t=t, contact=np.zeros(4, dtype=int), kind=kind), (0.0, 10.0))
    assert left.kind.tolist() == [EVENT_STICK, EVENT_ASKED, EVENT_SLIP]


@pytest.mark.parametrize(
    ("before", "left"),
    [
        ([EVENT_SLIP], []),
        ([EVENT_SLIP, EVENT_ASKED], [EVENT_ASKED]),
        ([EVENT_REVERSAL, EVENT_ASKED], [EVENT_ASKED, EVENT_STICK]),
        ([EVENT_SLIP, EVENT_REVERSAL], [EVENT_SLIP, EVENT_STICK]),
        ([EVENT_ASKED], [EVENT_ASKED, EVENT_STICK]),
    ],
)
def test_stick_takes_back_what_happened_at_its_instant(before, left):
    put = getattr(record_event, "py_func", record_event)
    out = SimpleNamespace(event=np.zeros((9, 3)), used=np.zeros(2, dtype=np.int64))
    for kind in [*before, EVENT_STICK]:
        put(out, 3.0, 0, kind)
    assert out.event[: out.used[1], 2].tolist() == left
