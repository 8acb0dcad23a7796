import functools
import os
import subprocess
import sys
import threading
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse
import sympy

from fricmb._sweep._fingerprint import Fingerprint, fingerprint
from fricmb.values import parameter

SCRIPT = """
import numpy as np, sympy
from fricmb._sweep._fingerprint import Fingerprint, fingerprint
def reduce(sol):
    return {name for name in ("a", "b", "c")}, sol.t in {"x", "y", "z"}
print(fingerprint({"b": 1.0, "a": np.arange(3)}, sympy.Symbol("x") + 1, reduce, (None, True, "x")))
"""


def test_it_is_the_same_in_every_process():
    def run(seed):
        environment = dict(os.environ, PYTHONHASHSEED=seed)
        command = [sys.executable, "-c", SCRIPT]
        return subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout

    found = {run("1"), run("2")}
    assert len(found) == 1
    assert len(found.pop().strip()) == 64


@dataclass(frozen=True)
class Thing:
    a: float
    b: tuple


def scaled(factor):
    return lambda sol: factor * sol


VALUES = [
    None, 0, 1, 1.0, True, "1", b"1", (1, 2), (12,), ((1,), 2), {"a": 1}, {"a": 2}, {"b": 1}, np.zeros(2),
    np.zeros((2, 1)), np.zeros(2, dtype=int), np.nextafter(1.0, 2.0), sympy.Symbol("x"), sympy.Symbol("y"),
    parameter("k", 1.0), parameter("k", 2.0), parameter("k", 1.0) * sympy.Symbol("x"),
    parameter("k", 2.0) * sympy.Symbol("x"), Thing(1.0, ()), Thing(2.0, ()), Thing(1.0, (0,)), scaled(1.0), scaled(2.0),
    lambda s: s.t, lambda s: s.q, lambda s: s.q[0], lambda s: s.q[1],
    functools.partial(max, 1), functools.partial(max, 2),
    scipy.sparse.eye(3), scipy.sparse.eye(4),
]  # fmt: skip


def test_different_things_have_different_ones():
    found = [fingerprint(value) for value in VALUES]
    same = [(i, found.index(print)) for i, print in enumerate(found) if found.index(print) != i]
    assert not same, [(VALUES[i], VALUES[j]) for i, j in same]


@pytest.mark.parametrize("value", VALUES, ids=lambda v: type(v).__name__)
def test_it_does_not_change(value):
    assert fingerprint(value) == fingerprint(value)


def test_the_order_of_a_dict_does_not_count():
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})


def test_a_class_counts_by_its_code():
    def law(body):
        source = f"@dataclass(frozen=True)\nclass Law:\n    a: float\n    def f(self): return {body}"
        space = {"__name__": "mine", "dataclass": dataclass}
        exec(source, space)
        return space["Law"](1.0)

    assert fingerprint(law("self.a")) == fingerprint(law("self.a"))
    assert fingerprint(law("self.a")) != fingerprint(law("-self.a"))


MODULE = """
import math
import {helper} as aside
from {helper} import doubled

FACTOR = {factor}
TABLE = {{"a": [1.0, {factor}]}}


def inner(x):
    return x + {shift}


def reduce(sol):
    return inner(FACTOR * doubled(sol)) + aside.tripled(sol) + math.pi


def recursive(n):
    return n and recursive(n - 1) + TABLE["a"][1]


class Law:
    LIMIT = {limit}

    @property
    def value(self):
        return self.LIMIT + inner(0)
"""


def user_module(tmp_path, monkeypatch, *, factor=1.0, shift=2.0, limit=3.0, times=2.0, other=3.0):
    """A script with a helper module beside it, as a user has them."""
    name = f"helper_{abs(hash(tmp_path))}"
    (tmp_path / f"{name}.py").write_text(
        f"def doubled(x):\n    return {times} * x\ndef tripled(x):\n    return {other} * x\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    space = {"__name__": "script"}
    exec(MODULE.format(helper=name, factor=factor, shift=shift, limit=limit), space)
    return space


@pytest.mark.parametrize(
    ("change", "seen"),
    [
        ({}, set()),
        ({"factor": 5.0}, {"reduce", "recursive"}),
        ({"shift": 5.0}, {"reduce", "Law"}),
        ({"limit": 5.0}, {"Law"}),
        ({"times": 5.0}, {"reduce"}),
        ({"other": 5.0}, {"reduce"}),
    ],
)
def test_helpers_and_globals_are_followed(tmp_path, monkeypatch, change, seen):
    names = ("reduce", "recursive", "Law")
    before = user_module(tmp_path, monkeypatch)
    kept = {name: fingerprint(before[name]) for name in names}
    after = user_module(tmp_path, monkeypatch, **change)
    assert {name for name in names if fingerprint(after[name]) != kept[name]} == seen


def test_what_cannot_be_followed_is_told():
    lock = threading.Lock()

    def reduce(sol):
        with lock:
            return sol

    found = Fingerprint()
    found.of(reduce)
    assert found.unseen == ["a _thread.lock"]


def test_defaults_count_and_docstrings_do_not():
    def made(default, named, doc):
        space = {"__name__": "mine"}
        exec(f"def reduce(sol, a={default}, *, b={named}):\n    '''{doc}'''\n    return a + b", space)
        return fingerprint(space["reduce"])

    assert made(1, 2, "Some.") == made(1, 2, "Other.")
    assert len({made(1, 2, ""), made(2, 2, ""), made(1, 3, "")}) == 3


def test_runs_of_a_store_from_another_process_are_found(tmp_path):
    """Keys of what a sweep is given, a function and its helper among it, are those of yesterday's process."""
    (tmp_path / "study.py").write_text(
        "import sys\nimport fricmb as fm\n"
        "def peak(sol):\n    calls.append(1)\n    return float(abs(sol['mass.x']).max())\n"
        "calls = []\n"
        "def reduce(sol):\n    return peak(sol)\n"
        "if __name__ == '__main__':\n"
        "    runs = [{'spring.stiffness': k} for k in (1.0, 2.0)]\n"
        "    found = fm.sweep(fm.models.belt_oscillator(), runs, t_end=1.0, reduce=reduce, store='kept', workers=1,"
        " progress=False)\n"
        "    print(list(found), len(calls))\n"
    )
    run = [sys.executable, "study.py"]
    first, second = (subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True).stdout for _ in "12")
    assert first.rsplit(maxsplit=1)[1] == "2"
    assert second.rsplit(maxsplit=1) == [first.rsplit(maxsplit=1)[0], "0"]
