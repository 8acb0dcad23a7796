"""The template of a package with a friction law: it installs as it is, fricmb finds its law, its own tests pass."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TEMPLATE = Path(__file__).parents[1] / "template"


def run(*command, installed=None, cwd=None):
    """A command as a user types it, with the installed package on the path."""
    path = os.pathsep.join(map(str, filter(None, (installed, os.environ.get("PYTHONPATH")))))
    done = subprocess.run(
        [sys.executable, "-m", *map(str, command)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A copy of the template, installed without an index: what builds it comes with the extra ``test``."""
    folder = tmp_path_factory.mktemp("template")
    copy = shutil.copytree(TEMPLATE, folder / "copy", ignore=shutil.ignore_patterns("build", "*.egg-info"))
    options = ["-q", "--no-index", "--no-deps", "--no-build-isolation"]
    run("pip", "install", *options, "--target", folder / "installed", copy)
    return folder / "installed"


def test_law_is_listed(installed, tmp_path):
    listed = run("fricmb", "list", "laws", installed=installed, cwd=tmp_path)
    assert "Valley (set-valued)\n      mu(r) = mu_s - (mu_s - mu_min)" in listed
    assert "mu_s=0.6, mu_min=0.4, v_min=0.1" in listed


def test_law_is_drawn(installed, tmp_path):
    told = run("fricmb", "law", "Valley", "--set", "v_min=0.05", "--out", tmp_path, installed=installed, cwd=tmp_path)
    assert "Valley(mu_s=0.6, mu_min=0.4, v_min=0.05)" in told
    assert (tmp_path / "Valley.png").stat().st_size > 10_000


@pytest.mark.slow
def test_its_own_tests_pass(installed, tmp_path):
    tests = shutil.copytree(TEMPLATE / "tests", tmp_path / "tests")
    told = run("pytest", "-q", "-p", "no:cacheprovider", tests, installed=installed, cwd=tmp_path)
    assert re.search(r"5 passed", told)


@pytest.mark.slow
def test_its_readme_runs(installed, tmp_path):
    (code,) = re.findall(r"```python\n(.*?)```", (TEMPLATE / "README.md").read_text(), re.DOTALL)
    (tmp_path / "readme.py").write_text(code)
    run("readme", installed=os.pathsep.join([str(installed), str(tmp_path)]), cwd=tmp_path)
