"""What happens at one instant is told once."""

import numpy as np
import pytest

from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK
from fricmb.integrate.run.told_once import told_once
from fricmb.integrate.trajectory import Transitions


def told(*events):
    t, kind = zip(*events, strict=True)
    given = Transitions(t=np.array(t), contact=np.zeros(len(t), dtype=int), kind=np.array(kind))
    left = told_once(given, (0.0, 10.0))
    return list(zip(left.t.tolist(), left.kind.tolist(), strict=True))


@pytest.mark.parametrize(
    ("first", "second", "apart", "left"),
    [
        (EVENT_REVERSAL, EVENT_STICK, 5e-10, [EVENT_STICK]),
        (EVENT_REVERSAL, EVENT_STICK, 5e-9, [EVENT_REVERSAL, EVENT_STICK]),
        (EVENT_SLIP, EVENT_REVERSAL, 5e-12, [EVENT_SLIP]),
        (EVENT_SLIP, EVENT_REVERSAL, 5e-10, [EVENT_SLIP, EVENT_REVERSAL]),
        (EVENT_REVERSAL, EVENT_REVERSAL, 5e-12, []),
        (EVENT_SLIP, EVENT_STICK, 5e-12, [EVENT_SLIP, EVENT_STICK]),
    ],
)
def test_two_at_one_instant(first, second, apart, left):
    found = told((3.0, first), (3.0 + apart, second), (7.0, EVENT_SLIP))
    assert [kind for _, kind in found] == [*left, EVENT_SLIP]
    assert all(t in (3.0, 3.0 + apart, 7.0) for t, _ in found)


def test_what_is_brief_by_itself_is_kept():
    """The next transition follows as soon: this is how fast things happen here."""
    kinds = [EVENT_REVERSAL, EVENT_STICK, EVENT_SLIP]
    assert [kind for _, kind in told(*((3.0 + i * 2e-10, kind) for i, kind in enumerate(kinds)))] == kinds
