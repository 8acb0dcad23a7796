"""The interactive view of a run: its scene in motion, its signals over time and over one another, in one HTML file."""

from __future__ import annotations

import json
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.plot._contact import STICK, phases
from fricmb.plot._fine import Floats
from fricmb.plot._html import block, resource, rounded, short
from fricmb.plot._make_sketch import DRAWN, PICTURES, in_space, is_drawn, shown_span, sketch_of_run
from fricmb.plot._sketch import Sketch, Touch
from fricmb.plot._units import bare, unit_of_signal
from fricmb.solution._stored import Stored

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Times of a view at most, numbers in it altogether, and signals that are offered at most.
_TIMES, _NUMBERS, _SIGNALS = 4000, 250_000, 200
#: Bins of the bounds of a signal over a run that has too many swings for the times, and samples in each.
_BINS, _SAMPLES = 500, 24
#: Seconds that a swing lasts.
_SWING = 1.3


def solution_html(
    sol: Solution, *, t_start: float | None = None, t_end: float | None = None, magnify: float | None = None
) -> str:
    """A run: its scene in motion, any of its signals over time with stick shaded, and any over any other."""
    names = list(sol.columns())[:_SIGNALS]
    begin, end, pictures = shown_span(sol, t_start, t_end)
    times = _times(sol, begin, end, len(names))
    every = sol.at(times).columns()
    drawn = is_drawn(sol.scene)
    spatial = drawn and in_space(sol.scene)
    data = {
        "t": rounded(times, 9),
        "span": [begin, end],
        "seconds": max(2.0, _SWING * pictures / PICTURES),
        "time": "" if sol.units.time in ("1", "time") else sol.units.time,
        "signals": {name: rounded(every[name]) for name in names},
        "labels": {name: _unit(sol, name) for name in names},
        "stick": _stuck(sol),
        "touching": _touching(sol),
        "bounds": _bounds(sol, names) if (end - begin) < 0.5 * (sol.t_end - sol.t_start) else None,
        "sketch": _sketch(sketch_of_run(sol, times, magnify)) if drawn and not spatial else None,
        "space": _in_space(sol, times) if spatial else None,
        **_first(sol, names),
    }
    script = resource("view.js").replace("SPACE", resource("space/space.js") if spatial else "null")
    script = script.replace("DATA", json.dumps(data, allow_nan=False).replace("<", "\\u003c"))
    return block(
        f"<b>{escape(str(sol.scene.name))}</b>",
        _controls(names, drawn),
        f"<details><summary>summary of the run</summary><pre>{escape(sol.summary())}</pre></details>",
        f"<script>{script}</script>",
    )


def solution_notebook(sol: Solution) -> str:
    """What a notebook shows; of a loaded file a line, since more would open the run in it unasked."""
    if isinstance(sol._run, Stored):
        return block(f"<pre>{escape(repr(sol))}</pre>sol.plot.view(path) writes an interactive view")
    return solution_html(sol)


def solution_page(
    sol: Solution, *, t_start: float | None = None, t_end: float | None = None, magnify: float | None = None
) -> str:
    """The view of a run as a page of its own."""
    title = escape(str(sol.scene.name))
    head = (
        '<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark"><link rel="icon" href="data:,">'
        f"<title>{title}</title><style>body{{margin:0 auto;max-width:1180px}}</style></head>"
    )
    body = solution_html(sol, t_start=t_start, t_end=t_end, magnify=magnify)
    return f'<!DOCTYPE html><html lang="en">{head}<body>{body}</body></html>'


def _controls(names: list[str], drawn: bool) -> str:
    options = "".join(f"<option>{escape(name)}</option>" for name in names)
    speeds = "".join(f'<option value="{v}"{" selected" if v == "1" else ""}>{v} x</option>' for v in _SPEEDS)
    scene = '<canvas class="scene" role="img" aria-label="the scene in motion"></canvas>'
    return (
        '<div class="fricmb-bar"><button class="play" type="button" aria-pressed="false">Play</button>'
        '<input type="range" min="0" max="1000" value="0" aria-label="time"><output></output>'
        f'<select class="speed" aria-label="speed">{speeds}</select></div>'
        '<div class="fricmb-bar"><button class="part" type="button">A few swings</button>'
        '<button class="whole" type="button">Whole run</button>'
        '<button class="nearer" type="button" aria-label="enlarge about the cursor">Zoom in</button>'
        '<button class="farther" type="button" aria-label="show a longer stretch">Zoom out</button></div>'
        f'<div class="fricmb-panes">{f"<figure>{scene}</figure>" if drawn else ""}'
        '<figure><canvas class="plane" role="img" aria-label="one signal over another"></canvas>'
        f'<label>x <select class="across">{options}</select></label>'
        f'<label>y <select class="up">{options}</select></label></figure><figure class="wide">'
        '<canvas class="time" role="img" aria-label="signals over time; drag to move in time"></canvas>'
        f'<p class="told"></p><label>signal <select class="first">{options}</select></label>'
        f'<label>and <select class="second"><option></option>{options}</select></label></figure></div>'
    )


_SPEEDS = ("0.25", "0.5", "1", "2", "4")


def _times(sol: Solution, begin: float, end: float, signals: int) -> Floats:
    """Times of the whole run, most of them in the part that is shown first."""
    moved = (7 if in_space(sol.scene) else 3) * min(DRAWN, len(sol.scene.bodies) + len(sol.scene.driven))
    count = int(np.clip(_NUMBERS / max(1, signals + moved), 300, _TIMES))
    whole = np.linspace(sol.t_start, sol.t_end, count // 3 if end - begin < sol.t_end - sol.t_start else count)
    return np.unique(np.concatenate((whole, np.linspace(begin, end, count - len(whole) or 2))))


def _unit(sol: Solution, name: str) -> str:
    """What stands in brackets behind a column; nothing where a unit would say nothing."""
    if name.endswith(".mode"):
        return "0 stick, 1 slip, 2 open"
    return bare(f"[{unit_of_signal(sol, name, sol.units)[1]}]").strip("[]")


def _first(sol: Solution, names: list[str]) -> dict[str, Any]:
    """The signals that are shown first: of the motion that turns round most often by the largest amount."""
    swing = [float(np.abs(np.diff(v)).sum() - abs(v[-1] - v[0])) for v in sol.v] if sol.t.size > 1 else [0.0]
    name = sol.dof_names[int(np.argmax(swing))]
    velocity = f"{name}.velocity"
    both = name in names and velocity in names
    return {"first": velocity if both else names[0], "plane": [name, velocity] if both else [names[0], names[-1]]}


def _bounds(sol: Solution, names: list[str]) -> dict[str, Any]:
    """Least and largest value of every signal in bins over the run."""
    edges = np.linspace(sol.t_start, sol.t_end, _BINS + 1)
    seen = sol.at(np.linspace(sol.t_start, sol.t_end, _BINS * _SAMPLES)).columns()
    values = {}
    for name in names:
        rows = np.asarray(seen[name], dtype=float).reshape(_BINS, _SAMPLES)
        values[name] = [rounded(rows.min(axis=1), 5), rounded(rows.max(axis=1), 5)]
    return {"t": rounded(0.5 * (edges[:-1] + edges[1:]), 8), "values": values}


def _stuck(sol: Solution) -> dict[str, list[list[float]]]:
    """Stretches of stick by contact."""
    found = {}
    for name, (bounds, mode) in zip(sol.contact_names, phases(sol), strict=True):
        found[name] = [[float(bounds[i]), float(bounds[i + 1])] for i in np.flatnonzero(mode == STICK)]
    return found


def _touching(sol: Solution) -> dict[str, str]:
    """The contact, or joint with friction, of each body that has just one: whose stick its signals show."""
    found: dict[str, list[str]] = {}
    for name in sol.contact_names:
        part = sol.scene[name]
        for end in (part.a, part.b):
            if hasattr(end.owner, "name"):
                found.setdefault(end.owner.name, []).append(name)
    return {body: contacts[0] for body, contacts in found.items() if len(contacts) == 1}


def _in_space(sol: Solution, times: Floats) -> dict[str, Any]:
    from fricmb.plot.space import space_data, space_sketch_of_run

    return space_data(space_sketch_of_run(sol, times))


def _sketch(sketch: Sketch) -> dict[str, Any]:
    """A sketch as data; of what does not change one value."""
    return {
        "view": sketch.view,
        "unit": sketch.unit,
        "reach": sketch.reach,
        "letters": sketch.letters,
        "floor": sketch.floor,
        "shapes": [
            {
                "name": shape.name,
                "face": shape.face,
                "outline": [rounded(point, 5) for point in shape.outline],
                "marks": [[rounded(point, 5) for point in mark] for mark in shape.marks],
                "label": shape.label,
                "band": shape.band,
            }
            for shape in sketch.shapes
        ],
        "places": [[short(row) for row in place] for place in sketch.places],
        "strokes": {str(k): short(shift) for k, shift in sketch.strokes.items()},
        "links": [vars(link) for link in sketch.links],
        "marks": [vars(mark) for mark in sketch.marks],
        "touches": [_touch(touch) for touch in sketch.touches],
    }


def _touch(touch: Touch) -> dict[str, Any]:
    assert touch.force is not None
    assert touch.mode is not None
    force = touch.force
    along = force[:, int(np.argmax(np.hypot(*force)))]
    size = float(np.hypot(*along))
    return {
        "at": touch.at,
        "turns": touch.turns,
        "force": [short(row) for row in force],
        "limit": None if touch.limit is None else short(touch.limit),
        "mode": touch.mode[:1].tolist() if np.ptp(touch.mode) == 0 else touch.mode.tolist(),
        "along": rounded(along / size) if size > 0.0 else [1.0, 0.0],
        "planar": bool(np.ptp(force[0]) > 0.0 and np.ptp(force[1]) > 0.0),
    }
