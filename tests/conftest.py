"""Settings of the whole suite."""

import os
import signal
import sys
from pathlib import Path

import pytest
from hypothesis import settings

# how long an example takes says something of the machine only
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

# what runs in the background may be told to ignore Ctrl-C: a test that sends it would wait for ever
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# so that tests of tests.oracle find it; last, so that fricmb is the one installed
sys.path.append(str(Path(__file__).parents[1]))


#: Set for the processes of a run of the quick part.
QUICK = "FRICMB_QUICK_TESTS"


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config):
    """`pytest` alone runs the quick part, by two processes; `pytest tests`, and what else is asked for, all of it."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        return
    os.environ.pop(QUICK, None)
    asked = config.args_source is not pytest.Config.ArgsSource.TESTPATHS
    if asked or config.option.markexpr or config.option.keyword or config.option.collectonly:
        return
    os.environ[QUICK] = "1"
    if getattr(config.option, "numprocesses", 0) is None and not config.option.usepdb:
        config.option.numprocesses = 2


def pytest_report_header(config):
    """What is left out, and how to have it."""
    return "without slow tests; `pytest -n 2 tests` runs all" if QUICK in os.environ else None


def pytest_collection_modifyitems(config, items):
    """Leave slow tests out of the quick part."""
    if QUICK in os.environ:
        slow = [item for item in items if item.get_closest_marker("slow")]
        config.hook.pytest_deselected(items=slow)
        items[:] = [item for item in items if not item.get_closest_marker("slow")]
