import os
import re
import shutil
import subprocess
import sys

import pytest

import fricmb as fm
from fricmb._simulate import _compile_watch
from fricmb.integrate.compile import cache_files, kernel_cache

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
    assert said.count("\n") == 1
    assert re.search(r"compiled functions in \d+\.\d s; later runs take what is compiled from the cache", said)


def test_loading_from_the_cache_is_timed_and_says_nothing(run):
    run()
    compiled, seconds, said = run()
    assert not compiled
    assert seconds > 0.0
    assert said == ""


SCENES = """
import sys
import fricmb as fm

block = fm.Body("block", mass=1.0)
spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
for factor in map(float, sys.argv[1:]):
    push = fm.Force("push", block, axis="x", value=1 / (factor + fm.t**2))
    fm.simulate(fm.Scene("s", [block, spring, push]), t_end=1.0, method="radau")
"""


def test_what_is_compiled_of_a_scene_is_named_and_nothing_is_called_first(tmp_path):
    """Each new formula of a scene was called the first compilation on this machine."""
    environment = dict(os.environ, FRICMB_CACHE_DIR=str(tmp_path))
    environment.pop("NUMBA_CACHE_DIR", None)
    fm.simulate(scene(), t_end=1.0, method="radau")  # so that its kernels are there
    kernels = cache_files.cache_folder("kernels")
    shutil.copytree(kernels, tmp_path / "kernels", ignore=shutil.ignore_patterns("kernel-*"))  # but those of formulas
    command = [sys.executable, "-c", SCENES, "1.25", "2.5", "3.75", "5", "6.25", "7.5"]
    said = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stderr.splitlines()
    assert [line for line in said if "first" in line] == []
    own = [line for line in said if re.search(r"compiled Force 'push' of this scene in \d+\.\d s", line)]
    assert len(own) == 3, "who makes a new formula for each run is told so, and not for each"


def scene():
    block = fm.Body("block", mass=1.0)
    return fm.Scene("s", [block, fm.Spring("spring", block, axis="x", stiffness=1.0)])


@pytest.mark.parametrize(
    ("made", "said"),
    [
        ({"why_none.txt": "no compiler here"}, "none were made when fricmb was installed, because no compiler here"),
        ({"kernels/a.nbc": ""}, "those made when fricmb was installed are for another processor"),
        ({}, "an editable install has none"),
    ],
)
def test_why_kernels_were_not_there_is_said_before_they_are_compiled(tmp_path, monkeypatch, capsys, made, said):
    for name, text in made.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(cache_files, "_SHIPPED", tmp_path)
    monkeypatch.setattr(_compile_watch.CompileWatch, "_told_kernels", False)
    with _compile_watch.CompileWatch() as watch:
        for told in kernel_cache.on_miss:
            told(cache_files.say)  # a function of the package, as one that the cache does not hold
    assert watch.compiled
    first, second = capsys.readouterr().err.splitlines()
    assert "compiling kernels for runs of this kind" in first
    assert said in first
    assert "compiled 1 kernel in 0.0 s" in second
