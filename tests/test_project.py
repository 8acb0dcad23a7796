"""What strangers meet: one version everywhere, lowest versions that are said, what they are told to run."""

import logging
import os
import re
import subprocess
import sys
import tomllib
from itertools import chain
from pathlib import Path

import pytest

from fricmb.integrate.compile.cache_files import say

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_the_version_to_cite_is_that_of_the_package():
    for name, pattern in (("CITATION.cff", r"^version: (\S+)$"), ("docs/reference/release.md", r"version = \{(\S+)\}")):
        found = re.findall(pattern, (ROOT / name).read_text(), re.MULTILINE)
        assert found == [PROJECT["version"]], name


def test_every_package_that_is_needed_has_a_lowest_version():
    needed = list(PROJECT["dependencies"])
    for extra in ("test", "fem", "pandas", "xarray", "dask"):
        needed += PROJECT["optional-dependencies"][extra]
    assert [need for need in needed if not re.match(r"[\w.\[\]-]+>=\d", need)] == []


def test_the_lowest_versions_are_printed_exactly():
    done = subprocess.run([sys.executable, ROOT / ".ci" / "lowest.py"], capture_output=True, text=True, check=True)
    lines = done.stdout.split()
    assert len(lines) == len(PROJECT["dependencies"]) + len(PROJECT["optional-dependencies"]["test"])
    assert all(re.fullmatch(r"[\w.\[\]-]+==[\d.]+", line) for line in lines)
    assert "numpy==2.0" in lines


def test_packages_that_several_extras_name_have_one_lowest_version():
    """An extra that asks for less would be tried with more."""
    found = {}
    for need in chain(PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()):
        name, _, bound = need.partition(">=")
        found.setdefault(name.partition("[")[0], set()).add(bound)
    assert {name: bounds for name, bounds in found.items() if len(bounds) > 1} == {}


def test_tests_need_no_compiler():
    """`spectrum` has no wheels."""
    assert not [need for need in PROJECT["optional-dependencies"]["test"] if need.startswith("spectrum")]


@pytest.mark.parametrize("quiet", [False, True])
def test_notices_go_to_a_logger_as_well(monkeypatch, caplog, capsys, quiet):
    monkeypatch.setenv("FRICMB_QUIET", "1" if quiet else "")
    with caplog.at_level(logging.INFO, logger="fricmb"):
        say("something was compiled")
    assert [(record.name, record.getMessage()) for record in caplog.records] == [("fricmb", "something was compiled")]
    assert capsys.readouterr().err == ("" if quiet else "fricmb: something was compiled\n")
    assert any(isinstance(handler, logging.NullHandler) for handler in logging.getLogger("fricmb").handlers)


def test_the_pages_of_a_project_are_there_and_the_checks_call_the_script():
    for name in ("SECURITY.md", "CODE_OF_CONDUCT.md", "CITATION.cff", ".pre-commit-config.yaml"):
        assert (ROOT / name).stat().st_size > 200, name
    yaml = pytest.importorskip("yaml")  # comes with dask
    forms = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))
    for path in [*forms, ROOT / "CITATION.cff", ROOT / ".pre-commit-config.yaml"]:
        assert isinstance(yaml.safe_load(path.read_text()), dict), path
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "checks.yml").read_text())["jobs"]
    runs = {name: [step["run"] for step in job["steps"] if "run" in step] for name, job in jobs.items()}
    assert runs == {"all": [".ci/run"], "quick": [".ci/run quick"]}
    subprocess.run(["bash", "-n", ROOT / ".ci" / "run"], check=True)


@pytest.mark.parametrize(
    ("arguments", "passed"),
    [([], 1), (["tests"], 2), (["-m", "slow"], 1), (["tests/test_one.py"], 2), (["-k", "_"], 2)],
)
def test_pytest_alone_is_the_quick_part(tmp_path, arguments, passed):
    (tmp_path / "tests").mkdir()
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text())
    (tmp_path / "tests" / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text())
    marked = "import pytest\n@pytest.mark.slow\ndef test_slow(): pass\ndef test_quick(): pass\n"
    (tmp_path / "tests" / "test_one.py").write_text(marked)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments]
    env = {name: held for name, held in os.environ.items() if not name.startswith(("PYTEST_", "FRICMB_"))}
    out = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=300).stdout
    assert re.search(rf"\b{passed} passed", out), out
    assert ("without slow tests" in out) == (not arguments)
    assert ("2 workers" in out) == (not arguments), out
