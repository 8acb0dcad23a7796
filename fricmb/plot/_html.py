"""Views for notebooks and browsers: HTML that stands alone and asks no network for anything."""

from __future__ import annotations

import base64
import io
import json
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fricmb.solution import Solution

_STYLE = (
    "<style>.fricmb{font-family:sans-serif;font-size:13px;max-width:860px}.fricmb td,.fricmb th{text-align:left;"
    "padding:1px 10px 1px 0;font-weight:normal}.fricmb th{color:#555}.fricmb canvas{border:1px solid #ccc;width:100%}"
    ".fricmb pre{font-size:12px;line-height:1.25}.fricmb details{margin:4px 0}</style>"
)
#: Points of a curve in a view of a run, numbers in it altogether, and signals that are offered at most.
_POINTS, _NUMBERS, _SIGNALS = 3000, 300_000, 200
#: Scenes of more bodies are not drawn.
_DRAWN = 60


def _block(*parts: str) -> str:
    return f'<div class="fricmb">{_STYLE}{"".join(parts)}</div>'


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"


def _image(figure: Figure) -> str:
    held = io.BytesIO()
    figure.savefig(held, format="png", dpi=90)
    text = base64.b64encode(held.getvalue()).decode()
    return f'<img alt="" src="data:image/png;base64,{text}">'


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else " ".join(str(value).split())[:120]


def scene_html(scene: Any) -> str:
    """A scene: its drawing, parts and parameters."""
    from fricmb.plot._scene import draw_scene

    parts = [(part.name, type(part).__name__) for part in scene.parts]
    values = [(name, _short(value)) for name, value in scene.parameters.items()]
    return _block(
        f"<b>{escape(scene.name)}</b> ({len(scene.dof_names)} degrees of freedom)<br>",
        _image(draw_scene(scene)) if len(scene.bodies) <= _DRAWN else "",
        f"<details><summary>{len(parts)} parts</summary>{_table(parts)}</details>",
        f"<details><summary>{len(values)} parameters</summary>{_table(values)}</details>",
    )


def plan_html(plan: Any) -> str:
    """A plan, as it prints."""
    return _block(f"<pre>{escape(str(plan))}</pre>")


def law_html(law: Any) -> str:
    """A law: its coefficient over the slip speed, and its parameters."""
    from fricmb.plot._law import law as draw_law

    values = [(name, _short(value)) for name, value in law.numeric_slots().items()]
    return _block(f"<b>{escape(type(law).__name__)}</b><br>", _image(draw_law(law)), _table(values))


def solution_html(sol: Solution) -> str:
    """A run: any of its signals over time, with stick shaded; drag to enlarge, double click for the whole."""
    names = list(sol.columns())[:_SIGNALS]
    t = np.linspace(sol.t_start, sol.t_end, max(300, min(_POINTS, _NUMBERS // max(1, len(names)))))
    every = sol.at(t).columns()
    columns = {name: every[name] for name in names}
    signals = {name: [float(f"{x:.6g}") for x in np.asarray(x, dtype=float)] for name, x in columns.items()}
    data = {"t": [float(f"{x:.8g}") for x in t], "signals": signals, "stick": _stuck(sol)}
    options = "".join(f"<option>{escape(name)}</option>" for name in signals)
    script = (
        files("fricmb.plot")
        .joinpath("view.js")
        .read_text(encoding="utf-8")
        .replace("DATA", json.dumps(data, allow_nan=False).replace("<", "\\u003c"))
    )
    return _block(
        f"<b>{escape(str(sol.scene.name))}</b><pre>{escape(sol.summary())}</pre>",
        f"<div><select>{options}</select> <select><option></option>{options}</select> <span></span></div>",
        '<canvas width="1700" height="600"></canvas>',
        f"<script>{script}</script>",
    )


def solution_notebook(sol: Solution) -> str:
    """What a notebook shows; of a loaded file a line, since more would open the run in it unasked."""
    from fricmb.solution._stored import Stored

    if isinstance(sol._run, Stored):
        return _block(f"<pre>{escape(repr(sol))}</pre>sol.plot.view(path) writes an interactive view")
    return solution_html(sol)


def solution_page(sol: Solution) -> str:
    """The view of a run as a page of its own."""
    title = escape(str(sol.scene.name))
    head = f'<head><meta charset="utf-8"><title>{title}</title></head>'
    return f"<!DOCTYPE html><html>{head}<body>{solution_html(sol)}</body></html>"


def _stuck(sol: Solution) -> dict[str, list[list[float]]]:
    """Stretches of stick by contact."""
    from fricmb.plot._contact import STICK, phases

    found = {}
    for name in sol.contact_names:
        bounds, mode = phases(sol, name)
        found[name] = [[float(bounds[i]), float(bounds[i + 1])] for i in np.flatnonzero(mode == STICK)]
    return found
