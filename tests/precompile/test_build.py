"""What a build puts into a wheel, what its name says, and what it leaves in the clone that it is made from."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = "import sys; from setuptools import build_meta; print(getattr(build_meta, sys.argv[1])(sys.argv[2]))"

pytest.importorskip("setuptools", minversion="77")


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """The sources as a clone has them, with what an earlier build left in it."""
    clone = tmp_path_factory.mktemp("clone") / "fricmb"
    clone.mkdir()
    made = ("__pycache__", "_build", "_made", "gallery", "generated", "jupyter_execute", "_*.md")
    skip = shutil.ignore_patterns("*.npz", *made)
    for name in ("fricmb", "models", "tests", "docs", "examples", "tools", "template", ".ci", ".github"):
        if (ROOT / name).exists():
            shutil.copytree(ROOT / name, clone / name, ignore=skip)
    for path in ROOT.iterdir():
        if path.is_file() and path.name != ".git":
            shutil.copy(path, clone)
    for lib in ("lib", f"lib.{sys.platform}-{sys.version_info[0]}.{sys.version_info[1]}"):
        for left in ("deleted.py", "_made/kernels/old.nbc"):
            path = clone / "build" / lib / "fricmb" / left
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("left by an earlier build\n")
    return clone


def start(clone, what, into, **env):
    command = [sys.executable, "-c", BUILD, what, str(into)]
    return subprocess.Popen(
        command, cwd=clone, env={**os.environ, **env}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def built(process, into):
    out, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    return into / out.split()[-1], err


def names(wheel):
    return set(zipfile.ZipFile(wheel).namelist())


def test_two_builds_at_once_ship_the_sources_as_they_are_and_leave_nothing(clone, tmp_path):
    """Modules that were deleted, and old kernels, were shipped from build/, where two builds also met."""
    before = sorted(clone.rglob("*"))
    places = [tmp_path / "one", tmp_path / "two"]
    both = [start(clone, "build_wheel", into, FRICMB_COMPILE="0") for into in places]
    wheels = [built(process, into)[0] for process, into in zip(both, places, strict=True)]
    assert names(wheels[0]) == names(wheels[1])
    assert {"fricmb/__init__.py", "fricmb/models/__init__.py"} <= names(wheels[0])
    assert not {"fricmb/deleted.py", "fricmb/_made/kernels/old.nbc"} & names(wheels[0])
    assert sorted(clone.rglob("*")) == before


def test_a_build_into_a_folder_that_was_used_before_empties_the_package_first(clone, tmp_path):
    """As with `python setup.py build --build-base build`."""
    left = tmp_path / "base" / "lib" / "fricmb" / "deleted.py"
    left.parent.mkdir(parents=True)
    left.write_text("")
    command = [sys.executable, "setup.py", "-q", "build", "--build-base", tmp_path / "base", "--build-lib"]
    env = {**os.environ, "FRICMB_COMPILE": "0"}
    subprocess.run([*command, left.parents[1]], cwd=clone, env=env, check=True, capture_output=True)
    assert (left.parent / "__init__.py").exists()
    assert not left.exists()


def test_a_wheel_without_kernels_is_for_every_processor_and_says_why_it_has_none(clone, tmp_path):
    """Its name told of one processor and one Python; what went wrong was shown by `pip install -v` alone."""
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "numba.py").write_text("raise RuntimeError('no compiler on this machine')\n")
    wheel, err = built(start(clone, "build_wheel", tmp_path, PYTHONPATH=str(tmp_path / "broken")), tmp_path)
    assert wheel.name.endswith("-py3-none-any.whl")
    assert "kernels are not compiled ahead of use: RuntimeError: no compiler on this machine" in err
    why = zipfile.ZipFile(wheel).read("fricmb/_made/why_none.txt").decode()
    assert why == "RuntimeError: no compiler on this machine"
    wheel, _ = built(start(clone, "build_wheel", tmp_path, FRICMB_COMPILE="0"), tmp_path)
    assert wheel.name.endswith("-py3-none-any.whl")
    assert zipfile.ZipFile(wheel).read("fricmb/_made/why_none.txt") == b"FRICMB_COMPILE=0 was set"


def test_an_editable_install_is_for_every_processor(clone, tmp_path):
    wheel, _ = built(start(clone, "build_editable", tmp_path), tmp_path)
    assert wheel.name.endswith("-py3-none-any.whl")


#: In place of `fricmb compile`, which takes minutes: puts a file where kernels are put.
INSTEAD = """
import os, sys
if "compile" in sys.argv:
    made = os.path.join(sys.argv[sys.argv.index("--into") + 1], "kernels")
    os.makedirs(made)
    open(os.path.join(made, "one.nbc"), "w").close()
    os._exit(0)
"""


def test_a_wheel_with_kernels_is_for_one_python_on_one_processor(clone, tmp_path):
    (tmp_path / "instead").mkdir()
    (tmp_path / "instead" / "numba.py").write_text(INSTEAD)
    wheel, _ = built(start(clone, "build_wheel", tmp_path, PYTHONPATH=str(tmp_path / "instead")), tmp_path)
    assert f"-cp{sys.version_info[0]}{sys.version_info[1]}-" in wheel.name
    assert "any" not in wheel.name.rpartition("-")[2]
    assert "fricmb/_made/kernels/one.nbc" in names(wheel)


def test_the_sdist_holds_tests_pages_and_examples(clone, tmp_path):
    archive, _ = built(start(clone, "build_sdist", tmp_path, FRICMB_COMPILE="0"), tmp_path)
    with tarfile.open(archive) as file:
        held = {name.partition("/")[2] for name in file.getnames()}
    wanted = {
        "pyproject.toml", "setup.py", "README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", ".ci/run",
        ".ci/lowest.py", "SECURITY.md", ".github/workflows/checks.yml",
        "fricmb/__init__.py", "models/__init__.py", "fricmb/py.typed", "tests/conftest.py", "docs/conf.py",
        "docs/start.md", "docs/images/steps.svg", "tools/soak.py",
    }  # fmt: skip
    assert wanted <= held, wanted - held
    for folder in ("tests", "docs", "examples", "template"):
        there = {p.relative_to(clone).as_posix() for p in (clone / folder).rglob("*") if p.is_file()}
        assert there <= held, sorted(there - held)[:5]
    assert not [name for name in held if name.startswith("build/") or "__pycache__" in name or "_build/" in name]
