"""Machine code is kept by content: an edit of what a kernel calls is seen, what is damaged is made again."""

import os
import subprocess
import sys
import textwrap

import pytest

PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from outer import outer
print(outer(2.0), sum(outer.stats.cache_misses.values()))
"""
INNER = """
from fricmb.integrate.compile.kernel import kernel
FACTOR = {factor}
@kernel
def inner(x: float) -> float:
    \"\"\"{doc}\"\"\"
    return FACTOR * x + {shift}
"""
OUTER = """
from fricmb.integrate.compile.kernel import entry
from inner import inner
@entry
def outer(x: float) -> float:
    return inner(x) + 1.0
"""


@pytest.fixture
def run(tmp_path):
    (tmp_path / "outer.py").write_text(textwrap.dedent(OUTER))
    kept = str(tmp_path / "kept")
    folders = {"NUMBA_CACHE_DIR": kept, "FRICMB_CACHE_DIR": kept, "TMPDIR": str(tmp_path)}

    def once(*, factor=3.0, shift=0.0, doc="Words."):
        (tmp_path / "inner.py").write_text(textwrap.dedent(INNER.format(factor=factor, shift=shift, doc=doc)))
        os.utime(tmp_path / "inner.py", (1e9, 1e9))  # times of files tell nothing
        command = [sys.executable, "-B", "-c", PROGRAM, str(tmp_path)]
        out = subprocess.run(command, env={**os.environ, **folders}, capture_output=True, text=True, check=True)
        value, misses = out.stdout.split()
        return float(value), int(misses), out.stderr

    once.kept = tmp_path / "kept" / "fricmb"
    return once


def test_an_edit_of_a_called_kernel_is_seen(run):
    assert run()[:2] == (7.0, 1)
    assert run()[:2] == (7.0, 0)
    assert run(shift=0.5)[:2] == (7.5, 1)
    assert run(factor=4.0)[:2] == (9.0, 1)
    assert run()[:2] == (7.0, 0), "what was compiled before is still there"
    assert run(doc="Other words.")[:2] == (7.0, 0), "a docstring is no code"


HANDED = """
from fricmb.integrate.compile.kernel import entry, kernel
from inner import inner
@kernel
def twice(f, x: float) -> float:
    return f(f(x))
@entry
def outer(x: float) -> float:
    return twice(inner, x) + 1.0
"""


@pytest.mark.parametrize("plain", ["", "1"])
def test_a_kernel_that_is_handed_to_another_is_read_and_kept_with_it(run, tmp_path, monkeypatch, plain):
    monkeypatch.setenv("FRICMB_PLAIN", plain)
    (tmp_path / "outer.py").write_text(HANDED)
    assert run()[:2] == (19.0, 1)
    assert run()[:2] == (19.0, 0)
    assert run(shift=0.5)[:2] == (21.0, 1)


DAMAGES = [lambda data: b"", lambda data: data[: len(data) // 2], lambda data: os.urandom(4000)]


@pytest.mark.parametrize("damage", DAMAGES, ids=["empty", "cut off", "foreign"])
def test_damaged_files_are_made_again_with_one_line(run, damage):
    run()
    (path,) = run.kept.glob("outer-*.nbc")
    path.write_bytes(damage(path.read_bytes()))
    value, misses, said = run()
    assert (value, misses) == (7.0, 1)
    assert said.count("\n") == 1
    assert "damaged" in said
    assert run() == (7.0, 0, "")


def test_a_single_flipped_bit_is_seen(run):
    run()
    (path,) = run.kept.glob("outer-*.nbc")
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(bytes(data))
    assert run()[:2] == (7.0, 1)


def test_a_folder_that_cannot_be_made_falls_back(run):
    run.kept.parent.write_text("a file stands where the folder should be")
    value, misses, said = run()
    assert (value, misses) == (7.0, 1)
    assert said.count("\n") == 1
    assert "cannot be kept" in said


def test_an_attribute_is_no_global_of_the_same_name():
    """What the module keeps under that name while it runs is not in the kernel, and does not make it a new one."""
    from fricmb.integrate.compile.content import KernelReader

    def lines(kept):
        around = {"kept": kept, "factor": 3.0}
        exec("def sum_up(room):\n    return factor * room.kept\n", around)
        around["sum_up"].__module__ = "fricmb.made_up"
        reader = KernelReader()
        reader.read(around["sum_up"])
        return reader.lines

    assert lines({}) == lines({id(lines): object()})
    assert "factor = float 3.0" in "\n".join(lines({}))


def test_a_kernel_that_moved_to_another_module_is_another_one():
    """What is kept names modules: a version that has other ones could not read it."""
    from fricmb.integrate.compile.content import KernelReader
    from fricmb.integrate.compile.kernel import kernel

    def lines(module):
        around = {}
        exec("def double(x):\n    return 2.0 * x\n", around)
        around["double"].__module__ = module
        reader = KernelReader()
        reader.read(kernel(around["double"]))
        return reader.lines

    assert lines("fricmb.here") == lines("fricmb.here")
    assert lines("fricmb.here") != lines("fricmb.there")


def test_a_run_by_bdf_compiles_nothing_the_second_time():
    program = (
        "import fricmb as fm, sys; fm.simulate(fm.models.belt_oscillator(), t_end=1.0, method='bdf');"
        "kernels = [m for n, m in sys.modules.items() if n == 'fricmb.integrate.implicit.time_loop'];"
        "print(sum(kernels[0].drive.stats.cache_misses.values()))"
    )
    run = [sys.executable, "-c", program]
    misses = [subprocess.run(run, capture_output=True, text=True, check=True).stdout.split()[-1] for _ in range(2)]
    assert misses[1] == "0", misses


ARRAYS = """
import sys
sys.path.insert(0, sys.argv[1])
from summed import summed
print(summed(2.0), sum(summed.stats.cache_misses.values()), "numba.np.arrayobj" in sys.modules)
"""
SUMMED = """
import numpy as np
from fricmb.integrate.compile.kernel import entry
@entry
def summed(x: float) -> float:
    held = np.zeros(3)
    held[:] = x
    return held.sum()
"""


def test_loading_imports_nothing_that_only_compiling_needs(tmp_path):
    """Numba's own functions in a kernel bring none of the modules that define them."""
    (tmp_path / "summed.py").write_text(SUMMED)
    kept = str(tmp_path / "kept")
    env = {**os.environ, "NUMBA_CACHE_DIR": kept, "FRICMB_CACHE_DIR": kept}
    for expected in ("6.0 1 True", "6.0 0 False"):
        command = [sys.executable, "-B", "-c", ARRAYS, str(tmp_path)]
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == expected
