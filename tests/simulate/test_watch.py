import os
import subprocess
import sys

import pytest

SCRIPT = """
import numba
from numba import cfunc, njit, types
from fricmb._simulate._compile_watch import CompileWatch

with CompileWatch() as watch:
    @njit(types.float64(types.float64), cache=True)
    def twice(x):
        return 2.0 * x

    @cfunc(types.float64(types.float64), cache=True)
    def thrice(x):
        return 3.0 * x

print(watch.compiled, watch.seconds)
"""


@pytest.fixture
def run(tmp_path):
    """Run the script in a new process with its own cache."""
    (tmp_path / "kernels.py").write_text(SCRIPT)
    environment = dict(os.environ, NUMBA_CACHE_DIR=str(tmp_path / "cache"))

    def run():
        result = subprocess.run(
            [sys.executable, tmp_path / "kernels.py"], capture_output=True, text=True, env=environment, check=True
        )
        compiled, seconds = result.stdout.split()
        return compiled == "True", float(seconds), result.stderr

    return run


def test_a_first_compilation_says_so_once_and_is_timed(run):
    compiled, seconds, said = run()
    assert compiled
    assert seconds > 0.0
    assert said.count("compiling for the first time") == 1


def test_loading_from_the_cache_is_timed_and_says_nothing(run):
    run()
    compiled, seconds, said = run()
    assert not compiled
    assert seconds > 0.0
    assert said == ""
