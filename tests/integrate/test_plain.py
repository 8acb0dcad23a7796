"""Kernels by numba's own passes: asked for, or where the quick ones do not work with the numba that is installed."""

from __future__ import annotations

import dis
import json
import os
import re
import subprocess
import sys
import types
from pathlib import Path

import numba
import numpy as np
import pytest

from fricmb.integrate.compile import plain
from fricmb.integrate.compile.fast import trial
from fricmb.integrate.compile.fast.names_taken import names_taken

#: What the quick passes rest on.  The list of numba's insides: each is renamed in a copy of it.
INSIDES = (
    "_blk_local_varmap", "_runPass",
    *(pytest.param(name, marks=pytest.mark.slow) for name in (
        "_LowerResult", "resolve_call", "_singly_assigned_vars", "_disable_sroa_like_opt", "_optimize_functions",
        "_optimize_final_module", "_finalize_dynamic_globals", "DefaultPassBuilder",
    )),
)  # fmt: skip

#: An entry, a kernel that it calls, and arrays in a room; told how often something was compiled, and by which passes.
PROGRAM = """
import json, sys
import numpy as np
sys.path.insert(0, sys.argv[1])
import kernels
from fricmb.integrate.compile.plain import is_plain
value = kernels.run()
print(json.dumps([value, sum(kernels.outer.stats.cache_misses.values()), is_plain(), kernels.passes()]))
"""
KERNELS = """
from __future__ import annotations
import numpy as np
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Floats2

class Box(Layout):
    h: float
    A: Floats2

@kernel
def inner(x: Floats) -> float:
    total = 0.0
    for i in range(x.shape[0]):
        total += x[i] / (i + 3.0)
    return total

@entry
def outer(box: Box) -> float:
    total = 0.0
    for i in range(box.A.shape[0]):
        total += inner(box.A[i]) * box.h
    return total

def run():
    return float(outer(room(Box(h=0.1, A=np.sqrt(np.arange(12.0)).reshape(3, 4)))))

def passes():
    (overload,) = outer.overloads.values()
    return type(overload.library).__name__
"""


@pytest.fixture
def run(tmp_path):
    (tmp_path / "kernels.py").write_text(KERNELS)

    def call(ahead: Path | None = None, **environment: str) -> tuple[list, str]:
        known = {k: v for k, v in os.environ.items() if not k.startswith(("FRICMB_", "NUMBA_"))}
        known |= {"FRICMB_CACHE_DIR": str(tmp_path / "kept")} | environment
        if ahead is not None:
            known["PYTHONPATH"] = str(ahead)
        found = subprocess.run(
            [sys.executable, "-c", PROGRAM, str(tmp_path)], capture_output=True, text=True, env=known, check=True
        )
        return json.loads(found.stdout), found.stderr

    return call


def test_both_give_the_same_and_what_they_made_is_kept_apart(run):
    (quick, misses, is_plain, library), said = run()
    assert (misses, is_plain, library, said) == (1, False, "MachineLibrary", "")
    (value, misses, is_plain, library), said = run(FRICMB_PLAIN="1")
    assert (misses, is_plain, library, said) == (1, True, "JITCodeLibrary", "")
    assert value == quick
    for environment in ({}, {"FRICMB_PLAIN": "0"}, {"FRICMB_PLAIN": "1"}):
        (value, misses, _, _), _ = run(**environment)
        assert (value, misses) == (quick, 0)


def renamed_copy(folder: Path, name: str) -> Path:
    """A numba in which a name is another one, wherever it stands; all other files are those of the one installed."""
    original = Path(numba.__file__).parent
    for top, folders, files in os.walk(original):
        here = folder / "numba" / Path(top).relative_to(original)
        here.mkdir(parents=True)
        folders[:] = [f for f in folders if f not in ("tests", "cuda")]
        for file in files:
            source = Path(top) / file
            text = source.read_text() if source.suffix == ".py" else ""
            if re.search(rf"\b{name}\b", text):
                (here / file).write_text(re.sub(rf"\b{name}\b", f"{name}_of_later", text))
            else:
                (here / file).symlink_to(source)
    for other in ("tests", "cuda"):
        (folder / "numba" / other).symlink_to(original / other)
    return folder


@pytest.mark.parametrize("name", INSIDES)
def test_a_numba_with_another_name_inside_is_done_without(run, tmp_path, name):
    copy = renamed_copy(tmp_path / "copy", name)
    (value, misses, is_plain, library), said = run(copy)
    assert value == pytest.approx(
        0.1 * (np.sqrt(np.arange(12.0)).reshape(3, 4) / (np.arange(4.0) + 3.0)).sum(), rel=1e-14
    )
    if is_plain:
        assert (misses, library) == (1, "JITCodeLibrary")
        assert said.count("\n") == 1
        assert "numba's own passes" in said
        assert name in said
        # what was made so is found again
        again, _ = run(copy)
        assert again[:3] == [value, 0, True]
    else:  # what is replaced is no longer asked for: compiling takes longer, and that is all
        assert name in {"_runPass", "resolve_call", "_optimize_functions", "_optimize_final_module"}
        assert (library, said) == ("MachineLibrary", "")


def test_what_fails_once_is_said_once(monkeypatch, capsys):
    def fails():
        raise AttributeError("no such name")

    monkeypatch.setattr(trial, "try_out", fails)
    monkeypatch.setattr(plain, "_plain", False)
    monkeypatch.setattr(plain, "_settled", False)
    assert plain.settle()
    assert not plain.settle()
    assert plain.is_plain()
    assert plain.quick_passes() is None
    assert capsys.readouterr().err.count("\n") <= 1


def test_the_kernel_of_the_trial_gives_what_python_gives():
    box = types.SimpleNamespace(h=0.5, x=np.array([1.0, 2.0, 3.0]), A=np.arange(6.0).reshape(2, 3))
    assert trial._outer_of(trial._inner)(box) == trial._WANTED
    trial.try_out()


def test_names_are_those_that_dis_finds():
    def sample(other):
        return np.sqrt(other.dis) + len(other.np) + dis.opmap["NOP"]

    assert names_taken(sample.__code__) == plain._names_by_dis(sample.__code__) == {"np", "len", "dis"}
    assert plain._names_reader() is names_taken or plain.is_plain()


def test_python_in_place_of_kernels_is_refused():
    program = "import fricmb as fm; fm.simulate(fm.models.belt_oscillator(), t_end=1.0)"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment)
    assert found.returncode
    last = found.stderr.strip().splitlines()[-1]
    assert last.startswith("fricmb.errors.FricmbError: NUMBA_DISABLE_JIT")


@pytest.mark.slow
def test_runs_are_the_same_to_the_digit(tmp_path):
    """Sums that take up one of two products unrounded name which, so that they are the same in whatever order."""
    program = (
        "import fricmb as fm; sol = fm.simulate(fm.models.brake4dof('2'), t_end=100.0, rtol=1e-8);"
        "print([x.hex() for x in sol.q[:, -1].tolist()], len(sol.events), sol.stats.n_steps)"
    )
    found = []
    for environment in ({}, {"FRICMB_PLAIN": "1"}, {"FRICMB_PLAIN": "1"}):  # compiled, and taken from the cache
        run = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, env=os.environ | environment, check=True
        )
        found.append(run.stdout)
    assert found[1] == found[0]
    assert found[2] == found[0]


def test_insides_are_named_behind_the_door_alone():
    """So that a numba with other ones concerns one folder; numba's compiler alone is asked for its own passes."""
    names = [getattr(name, "values", (name,))[0] for name in INSIDES] + ["_dynfunc", "PassManager", "JITCodeLibrary"]
    top = Path(plain.__file__).parents[2]
    found = {
        f"{path.relative_to(top)}: {name}"
        for path in top.rglob("*.py")
        if path.parent.name != "fast"
        for name in names
        if re.search(rf"\b{name}\b", path.read_text())
    }
    assert not found
    assert all((top / "integrate" / "compile" / "fast" / f"{name}.py").exists() for name in ("passes", "trial"))
