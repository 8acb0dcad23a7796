"""Damaged files: an error in fricmb's own words or what was saved, nothing executed (tools/fuzz_files.py runs more)."""

import importlib.util
from pathlib import Path

import pytest

PATH = Path(__file__).parents[2] / "tools" / "fuzz_files.py"


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("fuzz_files", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_damaged_files_are_refused(tool):
    found = tool.fuzz(400, 3)
    assert found["refused"] > 200
    assert found["another file that is sound"] > 10


def test_the_watch_sees_what_is_forbidden(tool):
    watch = tool.Watch()
    watch.on = True
    exec("pass")
    watch.on = False
    assert watch.seen
