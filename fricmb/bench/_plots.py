"""Pictures of the report, as inline SVG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np

Rows = Sequence[dict[str, Any]]

_OWN = {
    "auto": "k", "bdf": "C0", "radau": "C2", "collocation": "C3", "bdf2-paper": "C5", "taylor": "C9",
}  # fmt: skip
_MORE = ("C4", "C6", "C8")
_PEERS = {
    "scipy LSODA": "s", "scipy BDF": "^", "scipy Radau": "v", "scipy DOP853": "d", "CVODE": "P", "IDA": "X",
    "numbalsoda lsoda": "h", "numbalsoda dop853": "8", "Exudyn": "p", "Siconos": "D",
}  # fmt: skip


def _style(method: str, peer: bool) -> dict[str, Any]:
    if peer:
        marker = _PEERS.get(method, "*")
        grey = 0.4 + 0.04 * (list(_PEERS).index(method) if method in _PEERS else 10)
        return {"color": str(grey), "marker": marker, "linestyle": ":", "linewidth": 1.0, "markersize": 5}
    colour = _OWN.get(method) or _MORE[sum(method.encode()) % len(_MORE)]
    if method == "auto":
        return {"color": colour, "marker": "o", "linestyle": "-", "linewidth": 2.4, "markersize": 4, "alpha": 0.5}
    return {"color": colour, "marker": ".", "linestyle": "-", "linewidth": 1.2, "markersize": 6}


def _figure(width: float = 6.4, height: float = 4.2) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Any) -> str:
    """The figure as an SVG element without a header; its text stays text."""
    import matplotlib as mpl

    stream = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "fricmb"}):
        figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]


def _lines(axes: Any, rows: Rows, x: str, quantity: str) -> None:
    for method in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == method and row["metrics"]]
        points = [(row["metrics"][quantity], row[x] if x == "seconds" else row["counters"].get(x)) for row in mine]
        points = [(e, s) for e, s in points if e is not None and s and np.isfinite(e)]
        if points:
            errors, values = (np.array(column, float) for column in zip(*points, strict=True))
            peer = bool(mine[0]["peer"])
            style = _style(method, peer)
            axes.loglog(values, np.maximum(errors, 1e-16), label=method, zorder=1 if peer else 2, **style)


def work_precision(rows: Rows) -> Any:
    """State error and transition-time error against processor time."""
    has_times = any(row["metrics"] and row["metrics"]["time"] is not None for row in rows)
    figure = _figure(9.6 if has_times else 6.4)
    panels = figure.subplots(1, 2 if has_times else 1, squeeze=False, sharex=True)[0]
    labels = (("state", "state error"), ("time", "error of transition times / duration"))
    for axes, (quantity, label) in zip(panels, labels, strict=False):
        _lines(axes, rows, "seconds", quantity)
        axes.set_xlabel("processor time [s]")
        axes.set_ylabel(label)
        axes.grid(True, which="major", linewidth=0.3)
    handles, names = panels[0].get_legend_handles_labels()
    _widen(panels[0])
    figure.legend(handles, names, loc="outside right upper", fontsize=8, frameon=False)
    return figure


#: Where a mark stands that has no other program to compare with.
_EDGE = 1e3


def ahead(board: Rows) -> Any:
    """Time of the best peer over that of fricmb's default, a row a scene, a mark for each level of error."""
    cases = list(dict.fromkeys(entry["case"] for entry in board))
    levels = sorted({entry["level"] for entry in board}, reverse=True)
    figure = _figure(7.2, 0.9 + 0.24 * len(cases))
    axes = figure.subplots()
    for i, level in enumerate(levels):
        colour, height = ("C1", "C0", "C2", "C3")[i % 4], 0.22 * (i - 0.5 * (len(levels) - 1))
        ratios, rows, alone = [], [], []
        for entry in (entry for entry in board if entry["level"] == level):
            own, peer = entry["auto"] or entry["own"], entry["peer"]
            place = len(cases) - 1 - cases.index(entry["case"]) - height
            if own is not None and peer is not None:
                ratios.append(min(peer["seconds"] / own["seconds"], _EDGE))
                rows.append(place)
            elif own is not None:
                alone.append(place)
        axes.semilogx(ratios, rows, "o", color=colour, markersize=4, label=f"error {level:g}")
        axes.semilogx([_EDGE] * len(alone), alone, "o", color=colour, markersize=4, markerfacecolor="none")
    axes.axvline(1.0, color="0.2", linewidth=1.0)
    axes.set_yticks(range(len(cases)), cases[::-1], fontsize=8)
    axes.set_ylim(-0.7, len(cases) - 0.3)
    axes.set_xlabel("time of the fastest other program / time of fricmb")
    axes.grid(True, axis="x", which="major", linewidth=0.3)
    axes.grid(True, axis="y", linewidth=0.2)
    figure.legend(loc="outside upper right", ncols=len(levels), fontsize=8, frameon=False)
    return figure


def _widen(axes: Any) -> None:
    """At least a decade of time, with labels on powers of ten alone: closer ones would lie on each other."""
    from matplotlib.ticker import NullFormatter

    low, high = axes.get_xlim()
    if high < 10.0 * low:
        middle = (low * high) ** 0.5
        axes.set_xlim(middle / 10.0**0.5 / 1.1, middle * 10.0**0.5 * 1.1)
    axes.xaxis.set_minor_formatter(NullFormatter())


def convergence(rows: Rows, family: str) -> Any:
    """State error against the number of steps for the formulas of one family, with the fitted orders."""
    figure = _figure()
    axes = figure.subplots()
    for i, row in enumerate(rows):
        p = row["order"]
        label = row["method"] if p is None else f"{row['method']}: order {p:.1f}"
        axes.loglog(row["steps"], np.maximum(row["errors"], 1e-16), marker=".", linewidth=1, color=f"C{i}", label=label)
    axes.set_xlabel("steps")
    axes.set_ylabel("state error")
    axes.set_title(f"{family}: a slipping mass on a plane, without transitions", fontsize=10)
    axes.grid(True, linewidth=0.3)
    axes.legend(fontsize=8, frameon=False)
    return figure


def cost_against_size(rows: Rows, fits: dict[str, float | None], case: str, title: str) -> Any:
    """Processor time of a run against n."""
    figure = _figure(7.0)
    axes = figure.subplots()
    for method in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == method and row.get("seconds")]
        if not mine:
            continue
        power = fits.get(f"{case}/{method}")
        label = method if power is None else f"{method}: n^{power:.2f}"
        style = _style(method, method == "CVODE")
        axes.loglog([row["n"] for row in mine], [row["seconds"] for row in mine], label=label, **style)
    axes.set_xlabel("n")
    axes.set_ylabel("processor time of the run [s]")
    axes.set_title(title, fontsize=10)
    axes.grid(True, linewidth=0.3)
    figure.legend(loc="outside right upper", fontsize=8, frameon=False)
    return figure
