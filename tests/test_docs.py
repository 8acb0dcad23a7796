"""The code in the README and in the pages of the documentation runs, page by page, as it stands."""

import os
import re
import sys
import types
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# What is fenced as python, and the cells of pages that are notebooks (without their options).
BLOCK = re.compile(r"^```(?:python|\{code-cell\} python)\n(?::.*\n)*(.*?)^```", re.MULTILINE | re.DOTALL)
EVERYTHING = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
PAGES = [page for page in EVERYTHING if BLOCK.search(page.read_text())]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_code_on_the_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "MPLBACKEND", "Agg")
    file = tmp_path / f"{page.stem}.py"
    file.write_text("\n".join(BLOCK.findall(page.read_text())))
    # a module that can be imported, as the one that readers paste it into: its classes can be pickled
    module = types.ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)
    exec(compile(file.read_text(), str(file), "exec"), module.__dict__)


def test_readme_has_exactly_two_set_up_commands():
    indented = re.findall(r"^    (\S.*)$", (ROOT / "README.md").read_text().partition("## A scene")[0], re.MULTILINE)
    assert indented == ["pip install . && fricmb run brake4dof", 'pip install ".[test]" && pytest']
