"""Views for notebooks and browsers: HTML that stands alone and asks no network for anything."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def block(*parts: str) -> str:
    """Parts under the style that all views share."""
    return f'<div class="fricmb"><style>{resource("view.css")}</style>{"".join(parts)}</div>'


def resource(name: str) -> str:
    """A file that lies beside this one."""
    return files("fricmb.plot").joinpath(name).read_text(encoding="utf-8")


def rounded(values: Any, digits: int = 6) -> list[float]:
    """Numbers with as many digits as a picture shows; of a constant one."""
    return [float(f"{x:.{digits}g}") for x in np.asarray(values, dtype=float).tolist()]


def short(values: Any) -> list[float]:
    """The same; of what does not change the first alone."""
    return rounded(values[:1] if np.ptp(values) == 0.0 else values)


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"


def picture(draw: Callable[[], Figure]) -> str:
    """A picture, in the colours of the page that it stands on."""
    from fricmb.plot._style import theme

    drawn = {}
    for name in ("light", "dark"):
        held = io.StringIO()
        with theme(name):
            draw().savefig(held, format="svg", metadata={"Date": None})
        drawn[name] = "data:image/svg+xml;base64," + base64.b64encode(held.getvalue().encode()).decode()
    dark = f'<source srcset="{drawn["dark"]}" media="(prefers-color-scheme: dark)">'
    return f'<picture>{dark}<img alt="" src="{drawn["light"]}"></picture>'


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else " ".join(str(value).split())[:120]


def scene_html(scene: Any) -> str:
    """A scene: its drawing, parts and parameters."""
    from fricmb.plot._animation import draw_scene
    from fricmb.plot._make_sketch import is_drawn

    parts = [(part.name, type(part).__name__) for part in scene.parts]
    values = [(name, _short(value)) for name, value in scene.parameters.items()]
    return block(
        f"<b>{escape(scene.name)}</b> ({len(scene.dof_names)} degrees of freedom)<br>",
        picture(lambda: draw_scene(scene)) if is_drawn(scene) else "",
        f"<details><summary>{len(parts)} parts</summary>{_table(parts)}</details>",
        f"<details><summary>{len(values)} parameters</summary>{_table(values)}</details>",
    )


def plan_html(plan: Any) -> str:
    """A plan, as it prints."""
    return block(f"<pre>{escape(str(plan))}</pre>")


def law_html(law: Any) -> str:
    """A law: its coefficient over the slip speed, and its parameters."""
    from fricmb.plot._law import law as draw_law

    values = [(name, _short(value)) for name, value in law.numeric_slots().items()]
    return block(f"<b>{escape(type(law).__name__)}</b><br>", picture(lambda: draw_law(law)), _table(values))
