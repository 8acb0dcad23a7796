"""Templates on disk: a warm run needs no SymPy, processes may start together, a change derives again."""

import json
import os
import subprocess
import sys

import pytest

from fricmb.equations import _store
from fricmb.integrate.compile import cache_files

BRAKE = """
import json, sys, time
from fricmb.scene import Body, Contact, Damper, PointSpring, Scene, Spring
from fricmb.laws import Coulomb
from fricmb.system import build
import fricmb.equations as equations

pad = Body("pad", mass=1.0, axes="xy", position={"x": 1.0})
rotor = Body("rotor", mass=1000.0, axes="xy", velocity={"x": 10.0, "y": 0.01})
parts = [
    pad, rotor,
    Spring("k1x", pad, axis="x", stiffness=1.0, cubic=float(sys.argv[1])),
    Spring("k2y", rotor, axis="y", stiffness=0.25),
    Damper("c1x", pad, axis="x", damping=0.01),
    PointSpring("guide", pad, stiffness=1.0, length=0.5),
    Contact("lining", pad, rotor, law=Coulomb(mu_s=1.0), normal_force=15.0),
]
problem = build(Scene("brake", parts)).problem
print(json.dumps({
    "sympy": "sympy" in sys.modules,
    "derived": len(equations.derivations),
    "elements": len(problem.elements.table.address),
    "K": problem.linear.Kx.tolist(),
}))
"""


def start(tmp_path, cubic=0.5):
    folders = {"FRICMB_CACHE_DIR": str(tmp_path / "templates"), "NUMBA_CACHE_DIR": str(tmp_path / "numba")}
    return subprocess.Popen(
        [sys.executable, "-c", BRAKE, str(cubic)],
        env={**os.environ, **folders},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def result(process):
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return json.loads(out)


def test_a_warm_run_imports_no_sympy(tmp_path):
    cold = result(start(tmp_path))
    assert cold["sympy"]
    assert cold["derived"] == 4  # three types of element, one law
    warm = result(start(tmp_path))
    assert not warm["sympy"]
    assert warm["derived"] == 0
    assert warm["K"] == cold["K"]
    assert warm["elements"] == cold["elements"] == 2
    # other numbers need nothing new, and what is 0 is not there
    other = result(start(tmp_path, cubic=0.0))
    assert not other["sympy"]
    assert other["elements"] == 1


def test_processes_may_start_together_on_an_empty_cache(tmp_path):
    first, second = start(tmp_path), start(tmp_path)
    assert result(first)["K"] == result(second)["K"]
    left = [p.name for p in (tmp_path / "templates" / "templates").iterdir() if p.suffix == ".part"]
    assert left == []


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path))
    return tmp_path / "templates"


def test_damaged_files_are_derived_again_with_one_line(cache, capsys):
    key = _store.key("test", "a")
    assert _store.read(key) is None
    _store.write(key, {"n": 1}, "kernel = None\n")
    assert _store.read(key) == {"n": 1, "compiled": True}
    path = cache / f"{key}.json"
    whole = path.read_bytes()
    flipped = bytearray(whole)
    flipped[-5] ^= 1
    for broken in (b"", whole[:-20], os.urandom(300), b"{ cut off", bytes(flipped)):
        path.write_bytes(broken)
        capsys.readouterr()
        assert _store.read(key) is None
        assert capsys.readouterr().err.count("\n") == 1
        assert not path.exists()
    _store.write(key, {"n": 2}, None)
    assert _store.read(key) == {"n": 2, "compiled": False}


def test_keys_tell_content_apart():
    keys = {_store.key("a", 1), _store.key("a", 2), _store.key("b", 1), _store.key("a", 1, 2)}
    assert len(keys) == 4
    assert _store.key("a", 1) in keys


def test_a_folder_that_cannot_be_written_is_replaced(tmp_path, monkeypatch, capsys):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("FRICMB_CACHE_DIR", str(blocked))
    monkeypatch.setattr(_store._files, "_other", None)
    key = _store.key("test", "blocked")
    _store.write(key, {"n": 1}, None)
    assert _store.read(key) == {"n": 1, "compiled": False}
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "cannot be kept" in said


def test_a_full_disk_leaves_them_in_memory(tmp_path, monkeypatch, capsys):
    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setenv("FRICMB_CACHE_DIR", str(tmp_path / "full"))
    monkeypatch.setattr(_store._files, "_other", None)
    monkeypatch.setattr(cache_files, "_write", full)
    key = _store.key("test", "full")
    _store.write(key, {"n": 1}, None)
    assert _store.read(key) == {"n": 1, "compiled": False}
    assert "No space left on device" in capsys.readouterr().err


def test_a_read_only_warm_cache_is_used(tmp_path):
    """As in the image of a cluster: nothing new, nothing said, nothing written."""
    cold = result(start(tmp_path))
    (tmp_path / "templates" / "templates" / "killed.part").touch()
    for path in tmp_path.rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)
    try:
        before = sorted(tmp_path.rglob("*"))
        process = start(tmp_path)
        out, err = process.communicate(timeout=120)
        assert (process.returncode, err) == (0, "")
        assert json.loads(out)["derived"] == 0
        assert json.loads(out)["K"] == cold["K"]
        assert sorted(tmp_path.rglob("*")) == before
    finally:
        for path in tmp_path.rglob("*"):
            path.chmod(0o755)


def test_without_a_home_files_are_kept_for_the_process(monkeypatch, capsys):
    monkeypatch.setattr("platformdirs.user_cache_dir", lambda name: f"~/.cache/{name}")
    for name in ("FRICMB_CACHE_DIR", "NUMBA_CACHE_DIR", "FRICMB_TEMPORARY_CACHE"):
        monkeypatch.delenv(name, raising=False)
    for one in (cache_files._folder, cache_files._temporary):
        one.cache_clear()
    try:
        found = [cache_files.cache_folder(kind) for kind in ("kernels", "templates", "kernels")]
        assert all(path.is_absolute() and path.is_dir() for path in found)
        assert found[0] == found[2]
        assert "no home folder" in capsys.readouterr().err
    finally:
        for one in (cache_files._folder, cache_files._temporary):
            one.cache_clear()


SAME = """
import sys
from fricmb.equations import _store
source = "'Title %s.'" % sys.argv[1] + '''
from fricmb.integrate.compile.template import template
from fricmb.integrate.compile.straight_line_codegen import straight
statements = straight("out[0] = 2.0*x[0]")
@template
def kernel(x, p, out):
    statements(x, p, out)
'''
key = _store.key("test", sys.argv[1])
_store.write(key, {}, source)
import numpy as np
x, out = np.array([3.0]), np.zeros(1)
_store.function(_store.address(key))(x, x, out)
from fricmb.integrate.compile.kernel_cache import _files
print(out[0], len(list(_files.folder.glob("*.nbc"))))
"""


def test_two_templates_of_the_same_content_share_their_machine_code(tmp_path):
    """As after an upgrade that derives templates again and finds the same."""
    folders = {"FRICMB_CACHE_DIR": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path)}
    for title in ("one", "other", "one"):
        command = [sys.executable, "-c", SAME, title]
        done = subprocess.run(command, env={**os.environ, **folders}, capture_output=True, text=True, check=True)
        assert (done.stdout.split(), done.stderr) == (["6.0", "1"], "")
