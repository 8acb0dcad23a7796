"""Building the pages fails where a cell with ``alt`` shows no picture."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("myst_nb")

CONF = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parents[2] / "docs")!r})
import _described
extensions = ["myst_nb"]
nb_execution_mode = "force"
nb_execution_raise_on_error = True

def setup(app):
    app.connect("doctree-read", _described.check)
"""
PAGE = """---
file_format: mystnb
kernelspec: {{name: python3}}
---

# A page

```{{code-cell}} python
---
mystnb:
  image:
    alt: A line
---
from matplotlib.figure import Figure
import fricmb.plot._figure
figure = fricmb.plot._figure.new_picture(2.0, 1.0)
{last}
```
"""


def built(folder, last):
    (folder / "conf.py").write_text(CONF)
    (folder / "index.md").write_text(PAGE.format(last=last))
    command = [sys.executable, "-m", "sphinx", "-q", "-b", "html", str(folder), str(folder / "built")]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_a_cell_with_alt_has_a_picture(tmp_path):
    done = built(tmp_path, "figure")
    assert done.returncode == 0, done.stderr
    assert 'alt="A line"' in (tmp_path / "built" / "index.html").read_text()


def test_one_without_is_an_error(tmp_path):
    done = built(tmp_path, "done = figure")
    assert done.returncode != 0
    assert "index: a cell with this alt shows no picture: 'A line'" in done.stderr
