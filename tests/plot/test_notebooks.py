"""A notebook shows each picture once, with and without ``%matplotlib inline``; figures of others are left alone."""

import os
import subprocess
import sys

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")

#: As a user starts a kernel, whatever backend these tests run with.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"}
RUN = "import fricmb as fm\nsol = fm.simulate(fm.models.belt_oscillator(), t_end=5.0)"
#: A cell, and how many pictures it shows.
CELLS = {
    "figure = sol.plot.phase('mass.x')": 1,
    "sol.plot.velocities()": 1,
    "first, second = sol.plot.velocities(), sol.plot.energy()": 2,
    "from IPython.display import display\nfigure = sol.plot.energy()\ndisplay(figure)": 1,
    "figure": 1,
    "import io\nfor _ in range(3):\n    sol.plot.velocities().savefig(io.BytesIO())": 0,
    "sol.scene.draw()": 1,
    "fm.plot.show(sol.plot.velocities())": 1,
    "import matplotlib.pyplot as plt\nfig, ax = plt.subplots()\nlines = ax.plot([1, 2])": 1,
    "fig, ax = plt.subplots()\nsol.plot.phase('mass.x', ax=ax)\nprint(plt.get_fignums())": 1,
    # pyplot shows its figure at the end of the cell; the semicolon keeps the notebook from showing the value, too
    "fig, ax = plt.subplots()\nsol.plot.phase('mass.x', ax=ax);": 1,
    "fig, ax = plt.subplots()\npicture = sol.plot.phase('mass.x', ax=ax)": 1,
    "sol.plot.transitions().get_size_inches()": 1,
    "assert not plt.get_fignums()": 0,
}


def shown(before, cells):
    """How many pictures each cell shows in a new kernel."""
    notebook = nbformat.v4.new_notebook()
    notebook.cells = [nbformat.v4.new_code_cell(code) for code in (*before, RUN, *cells)]
    nbclient.NotebookClient(notebook, kernel_name="python3", timeout=300).execute(env=ENVIRONMENT)
    return {
        cell.source: sum("image/png" in output.get("data", {}) for output in cell.outputs)
        for cell in notebook.cells[len(before) + 1 :]
    }


@pytest.mark.parametrize(
    "before", [[], ["%matplotlib inline"], ["import matplotlib.pyplot as plt"], ["%matplotlib inline", "import pylab"]]
)
def test_each_picture_is_shown_once(before):
    assert shown(before, CELLS) == CELLS


def test_inline_display_asked_for_later_changes_nothing():
    cells = {"sol.plot.velocities()": 1, "%matplotlib inline": 0, "figure = sol.plot.energy()": 1, "figure ": 1}
    assert shown([], cells) == cells


def test_pictures_are_not_pyplots_and_their_settings_stay_inside():
    """In a process of its own: importing pyplot chooses a backend for all of it."""
    code = """
import sys
import matplotlib as mpl
import fricmb as fm

sol = fm.simulate(fm.models.belt_oscillator(), t_end=5.0)
mpl.rcParams["interactive"] = True
before = mpl.rcParams.copy()
for _ in range(25):
    sol.plot.velocities()
fm.plot.law_figure(fm.laws.Coulomb(mu_s=0.5))
assert mpl.rcParams.copy() == before
assert "matplotlib.pyplot" not in sys.modules
mpl.use("Agg")
import matplotlib.pyplot as plt
import warnings
assert not plt.get_fignums()
warnings.simplefilter("ignore")
picture = sol.plot.energy()
fm.plot.show(picture)
fm.plot.show(picture, sol.plot.velocities())
assert plt.get_fignums() == [1, 2] and plt.figure(1) is picture
"""
    subprocess.run([sys.executable, "-W", "error::RuntimeWarning", "-c", code], check=True, timeout=300)
