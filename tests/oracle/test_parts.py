"""Every element, normal law and joint beside dry friction, against the oracle in minimal coordinates."""

import inspect

import pytest

import fricmb as fm
from tests.oracle.judge import judge, truth
from tests.oracle.known import PARTS
from tests.oracle.parts import CASES
from tests.oracle.shrink import BAD
from tests.oracle.table import METHODS


def test_every_part_has_its_case():
    """Pins are in the chains, bodies of modes in the table of laws."""
    bases = (fm.Element, fm.Joint)
    public = {name: getattr(fm, name) for name in dir(fm)}
    parts = {name for name, kind in public.items() if inspect.isclass(kind) and issubclass(kind, bases)}
    parts = parts - {"Element", "Joint", "Revolute"} | {"MatrixElement", "Gravity", "DryFriction", "RollingResistance"}
    normals = {f"normal.{name}" for name in (*fm.normal.names, "Constant", "Prescribed")}
    assert {name.partition(",")[0] for name in CASES} == parts | normals


@pytest.mark.parametrize("name", CASES)
def test_part_moves_as_the_oracle_says(name):
    true = truth(CASES[name]())
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in METHODS}
    assert verdicts["auto"].kind == "right"
    wrong = {method: verdict for method, verdict in verdicts.items() if verdict.kind in BAD}
    # what is known to be wrong and is right has to go from the list
    assert wrong.keys() == {method for part, method in PARTS if part == name}, wrong
