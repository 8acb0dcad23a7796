"""The tool that sets scenes with impacts against event loops by hand: both get what is certified."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from sys import modules

import pytest

import fricmb as fm

SPEC = spec_from_file_location("impact_error", Path(__file__).parents[2] / "tools/impact_error.py")
tool = modules[SPEC.name] = module_from_spec(SPEC)
SPEC.loader.exec_module(tool)


@pytest.mark.parametrize("case", tool.SCENES, ids=lambda case: case.name)
def test_a_loop_by_hand_and_a_run_end_where_it_is_certified(case):
    exact = case.exact()
    assert tool.error(case.by_hand(1e-10), exact) < 1e-8
    for rtol in (1e-4, 1e-8):
        assert tool.error(case.ours(fm.simulate(case.scene(), t_end=case.t_end, rtol=rtol)), exact) < rtol
