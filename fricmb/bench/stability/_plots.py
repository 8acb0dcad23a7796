"""Pictures of stability regions."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.bench.stability._regions import STAGES, bdf_growth, radau_growth
from fricmb.integrate.formulas.backward_differences import MAX_ORDER


def _grid(left: float, right: float, top: float, count: int) -> tuple[Any, Any, Any]:
    x, y = np.linspace(left, right, count), np.linspace(-top, top, count)
    return x, y, x[None, :] + 1j * y[:, None]


def regions() -> Any:
    """Where each formula is unstable (inside its curve)."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    bdf, radau = figure.subplots(1, 2)
    x, y, z = _grid(-8.0, 22.0, 15.0, 121)
    for k in range(1, MAX_ORDER + 1):
        bdf.contour(x, y, bdf_growth(k, z), levels=[1.0], colors=[f"C{k - 1}"])
    orders = [Line2D([], [], color=f"C{k - 1}", label=f"order {k}") for k in range(1, MAX_ORDER + 1)]
    bdf.legend(handles=orders, fontsize=8)
    bdf.set_title("BDF: unstable inside", fontsize=10)
    x, y, z = _grid(-15.0, 60.0, 40.0, 121)
    for i, s in enumerate(STAGES):
        radau.contour(x, y, radau_growth(s, z), levels=[1.0], colors=[f"C{i}"])
    stages = [Line2D([], [], color=f"C{i}", label=f"{s} stages") for i, s in enumerate(STAGES)]
    radau.legend(handles=stages, fontsize=7, loc="upper left")
    radau.set_title("Radau IIA: unstable inside", fontsize=10)
    for axes in (bdf, radau):
        axes.axvline(0.0, color="0.6", linewidth=0.8)
        axes.set_xlabel("Re h λ")
        axes.set_ylabel("Im h λ")
    return figure


def axis() -> Any:
    """Growth and loss along the imaginary axis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 4.2), layout="constrained")
    growth, loss = figure.subplots(1, 2)
    w = np.linspace(0.02, 10.0, 500)
    for k in range(1, MAX_ORDER + 1):
        growth.plot(w, bdf_growth(k, 1j * w), label=f"BDF {k}", color=f"C{k - 1}")
    growth.axhline(1.0, color="0.6", linewidth=0.8)
    growth.set_xlabel("h ω")
    growth.set_ylabel("amplification a step")
    growth.legend(fontsize=8)
    for i, s in enumerate(STAGES):
        lost = -np.log(np.maximum(radau_growth(s, 1j * w), 1e-300)) / w
        lost[lost < 1e-14] = np.nan  # round-off
        loss.loglog(w, lost, label=f"{s} stages", color=f"C{i}")
    loss.set_xlabel("h ω")
    loss.set_ylabel("amplitude lost a radian, Radau IIA")
    loss.legend(fontsize=8)
    return figure
