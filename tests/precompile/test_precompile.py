"""Kernels compiled ahead of use: all of them, in several processes, found again where they were put."""

import os
import re
import runpy
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

import fricmb as fm
from fricmb.integrate.compile import cache_files
from fricmb.integrate.compile.kernel import _entries
from fricmb.integrate.compile.layout import argument_types
from fricmb.precompile import _compile, _crew, _tasks, compile_all
from fricmb.precompile._crew import Crew, Shares

TASKS = ["block lightness", "block share_load", "entry fricmb.integrate.model.table_values:_each"]
SHIPPED = """
import sys
from pathlib import Path
from fricmb.integrate.compile import cache_files
cache_files._SHIPPED = Path(sys.argv[1])
import fricmb.integrate.implicit.time_loop
from fricmb.integrate.compile.block import load_block, was_compiled
load_block("lightness")
print(was_compiled("lightness"))
"""


@pytest.fixture
def few(monkeypatch, tmp_path):
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(_compile, "kernels", lambda: TASKS)
    monkeypatch.setattr(_compile, "runs", lambda: ["model friction_oscillator"])
    return tmp_path


def test_each_task_is_taken_once_and_the_idle_help_from_the_end():
    shares = Shares([f"{i}" for i in range(7)], workers=2)
    assert [shares.next(0) for _ in range(3)] == ["0", "1", "2"]
    assert [shares.next(0), shares.next(1), shares.next(0)] == ["6", "3", "5"]
    assert [shares.next(1), shares.next(1), shares.next(0)] == ["4", None, None]


def test_after_ctrl_c_nobody_goes_on(monkeypatch):
    told, broken, crews = [], [], []
    monkeypatch.setattr(threading, "excepthook", broken.append)
    echo = [sys.executable, "-c", "import sys\nfor line in sys.stdin: print('{}', flush=True)"]
    pipe = subprocess.PIPE
    monkeypatch.setattr(_crew, "_worker", lambda: subprocess.Popen(echo, stdin=pipe, stdout=pipe, text=True))

    def report(task, answer):
        told.append(task)
        if len(told) == 3:
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        if len(told) >= 3:
            ended.wait(10.0)

    ended = threading.Event()

    def work():
        with Crew(2) as crew:
            crews.append(crew)
            try:
                crew.work_off([f"{i}" for i in range(100)], report)
            finally:
                ended.set()

    with pytest.raises(KeyboardInterrupt):
        work()
    for thread in set(threading.enumerate()) - {threading.current_thread()}:
        thread.join(10.0)
    assert all(process.poll() is not None for process in crews[0]._processes)
    assert len(told) < 6
    assert not broken


def test_what_is_for_later_comes_in_its_order_when_all_else_is_taken():
    shares = Shares(["a", "b"], workers=2, later=["x", "y"])
    assert [shares.next(0) for _ in range(5)] == ["a", "b", "x", "y", None]


@pytest.mark.slow
def test_what_is_made_is_copied_reported_and_found(few):
    seen = []
    files = compile_all(processes=2, into=few / "made", report=lambda *told: seen.append(told))
    assert sorted(task for task, _, _ in seen) == sorted([*TASKS, "model friction_oscillator"])
    assert [done for _, done, _ in seen] == [1, 2, 3, 4]
    assert {total for _, _, total in seen} == {4}
    there = {f"{path.parent.name}/{path.name}" for path in (few / "made").rglob("*") if path.is_file()}
    assert there == set(files)
    assert {name.partition("-")[0] for name in files} >= {"kernels/lightness", "kernels/share_load", "kernels/_each"}
    assert any(name.startswith("templates/") for name in files)
    empty = {**os.environ, "FRICMB_CACHE_DIR": str(few / "other")}
    command = [sys.executable, "-c", SHIPPED]
    for folder, compiled in ((few / "made", "False"), (few / "nothing", "True")):
        told = subprocess.run([*command, str(folder)], env=empty, capture_output=True, text=True, check=True)
        assert told.stdout.strip() == compiled


def test_what_the_package_carries_is_copied_too(monkeypatch, tmp_path):
    """An installed package with its kernels in it has nothing in the cache folder."""
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path / "empty"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(cache_files, "_SHIPPED", tmp_path / "made")
    (tmp_path / "made" / "kernels").mkdir(parents=True)
    (tmp_path / "made" / "kernels" / "one.nbc").write_bytes(b"code")
    _compile._copy({"one.nbc": _compile._kept("kernels", "one.nbc")}, tmp_path / "copy")
    assert (tmp_path / "copy" / "one.nbc").read_bytes() == b"code"
    with pytest.raises(fm.FricmbError, match=r"kernels/two\.nbc could not be kept"):
        _compile._kept("kernels", "two.nbc")


@pytest.mark.slow
def test_a_copy_is_made_where_the_cache_cannot_be_written(few, monkeypatch):
    """A file stands where its folder would be: nobody, not even root, can write into it."""
    (few / "file").write_text("")
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(few / "file"))
    monkeypatch.setattr(_compile, "runs", list)  # none: a kernel is as good as another
    files = compile_all(processes=1, into=few / "made")
    assert os.environ["FRICMB_CACHE_DIR"] == str(few / "file")
    assert {f"{path.parent.name}/{path.name}" for path in (few / "made").rglob("*") if path.is_file()} == set(files)
    assert {name.partition("-")[0] for name in files} >= {"kernels/lightness", "kernels/share_load", "kernels/_each"}


def test_a_process_that_dies_is_named_by_its_task(capfd):
    with Crew(1) as crew, pytest.raises(fm.FricmbError, match="block no_such_block"):
        crew.work_off(["block no_such_block"], lambda task, answer: None)
    assert "no_such_block" in capfd.readouterr().err


def test_a_process_that_died_before_its_first_task_is_told():
    with Crew(2) as crew:
        crew._processes[1].kill()
        crew._processes[1].wait()
        with pytest.raises(fm.FricmbError, match="block share_load"):
            crew.work_off(["block lightness", "block share_load"], lambda task, answer: None)


def test_workers_end_by_themselves():
    with Crew(1) as crew:
        crew.work_off(["block lightness"], lambda task, answer: None)
    assert [process.returncode for process in crew._processes] == [0]


def test_all_kernels_are_listed():
    tasks = _tasks.kernels()
    assert len(tasks) == len(set(tasks)) > 80
    entry = "entry fricmb.integrate.implicit.time_loop:drive"
    assert {"block attempt_step", "block taylor_series", entry} <= set(tasks)
    assert len(_tasks.runs()) == len(fm.models.catalogue) + 1


@pytest.mark.slow
def test_annotations_of_entries_are_the_types_of_their_calls():
    """Else a kernel compiled ahead of use would not be the one that is called."""
    times = [0.1, 0.2]
    for method in ("auto", "bdf", "radau", "taylor"):
        fm.simulate(fm.models.stick_slip_chain(3), t_end=0.3, t_eval=times, rtol=1e-4, method=method)
    fm.simulate(fm.models.brake4dof(), t_end=0.3, t_eval=times)
    fm.simulate(fm.models.belt_oscillator(), t_end=0.3, t_eval=times, method="collocation")
    fm.simulate(fm.models.belt_oscillator(), t_end=0.3, step=0.01, method="bdf2-paper")
    for method in ("bdf", "radau"):
        fm.simulate(fm.models.slider_crank(), t_end=0.01, t_eval=[0.005], method=method)
        fm.simulate(fm.models.slider_crank(), t_end=0.01, method=method)  # one instant alone is completed at its end
    fm.simulate(fm.models.bouncing_ball(), t_end=20.0)  # to their end
    block = fm.Body("b", mass=1.0)
    spring = fm.Spring("s", block, axis="x", stiffness=1.0, cubic=1.0)
    parts = [block, spring, fm.Force("f", block, axis="x", value=fm.t**2)]
    assert fm.simulate(fm.Scene("one", parts), t_end=1.0, method="radau").energy.residual.max() < 1e-6
    _tasks.kernels()
    own = {name: made for name, made in _entries.items() if name.startswith(("fricmb.integrate", "fricmb.system"))}
    called = {name: made for name, made in own.items() if made.overloads}
    assert len(called) >= len(own) - 2, sorted(set(own) - set(called))
    for name, made in called.items():
        assert set(made.overloads) == {argument_types(made.py_func)[0]}, name


KERNELS_ALONE = """
import sys
for name in ("scipy", "sympy", "mpmath", "matplotlib", "networkx"):
    sys.modules[name] = None  # importing them fails
from importlib import util
found = util.find_spec
util.find_spec = lambda name, *rest: None if name in sys.modules and sys.modules[name] is None else found(name, *rest)
from fricmb.precompile import _tasks
for name in _tasks.kernels():
    print(name)
print(_tasks.runs())
for task in ("block lightness", "entry fricmb.sensitivity._eliminate:small_maps"):
    _tasks.do(task)
"""


@pytest.mark.slow
def test_kernels_are_compiled_by_numba_alone():
    """The package is built where neither SciPy nor SymPy is installed."""
    command = [sys.executable, "-c", KERNELS_ALONE]
    *kernels, runs = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert runs == "[]"
    assert len(kernels) > 80
    assert set(kernels) <= set(_tasks.kernels())  # there may be more here: tests bring kernels of their own


def test_the_build_asks_for_what_kernels_need(monkeypatch):
    asked = {}
    monkeypatch.setattr("setuptools.setup", asked.update)
    runpy.run_path(str(Path(__file__).parents[2] / "setup.py"))
    names = {re.split("[<>=]", need)[0] for need in asked["setup_requires"]}
    assert names == {"numpy", "numba", "lazy_loader", "tqdm", "platformdirs", "threadpoolctl"}
