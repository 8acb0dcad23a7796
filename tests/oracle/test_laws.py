"""Every law in motion against the oracle, by every method that takes it."""

from functools import cache

import pytest

from fricmb import laws
from tests.oracle.judge import judge, truth
from tests.oracle.known import CELLS
from tests.oracle.shrink import BAD
from tests.oracle.table import LAWS, METHODS, SITUATIONS, case

#: One situation to each law, in turn; "long rest" costs the oracle most and is left to the full table, which
#: ``python -m tests.oracle --table`` runs.
_IN_TURN = [name for name in SITUATIONS if name != "long rest"]
QUICK = [(name, _IN_TURN[i % len(_IN_TURN)]) for i, name in enumerate(sorted(LAWS))]


def test_every_law_of_the_catalogue_has_its_row():
    assert set(LAWS) == set(laws.names)
    assert all(type(law).__name__ == name for name, law in LAWS.items())
    assert {name for name, _ in QUICK} == set(laws.names)


@cache
def said(name, situation):
    """What the oracle says."""
    return truth(case(name, situation))


def failures(name, situation):
    """Methods that get it wrong, with what they got."""
    true = said(name, situation)
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in METHODS}
    assert "auto" not in verdicts or verdicts["auto"].kind != "refused"
    return {method: verdict for method, verdict in verdicts.items() if verdict.kind in BAD}


@pytest.mark.parametrize(("name", "situation"), QUICK)
def test_law_moves_as_the_oracle_says(name, situation):
    """An entry of ``known.CELLS`` that passes has to go."""
    wrong = failures(name, situation)
    assert wrong.keys() == {method for *cell, method in CELLS if cell == [name, situation]}, wrong


def test_known_cells_are_those_of_the_quick_table():
    assert {cell[:2] for cell in CELLS} <= set(QUICK)
    assert {cell[2] for cell in CELLS} <= set(METHODS)
