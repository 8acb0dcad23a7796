"""What is read off the outcomes: scoreboard, tolerance statistic, orders."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

#: Errors for which the scoreboard gives the time.
LEVELS = (1e-2, 1e-4, 1e-6, 1e-8)
#: Bounds of error / (rtol growth) within which a tolerance means the error.
LOW, HIGH = 0.01, 100.0

Rows = Sequence[dict[str, Any]]


def fastest(rows: Rows, level: float) -> dict[str, Any] | None:
    """The run with the least time among those whose state error is at most ``level``, and no transition is wrong.

    A run with missed or false transitions does not count below 1e-2: it has another course.
    """
    good = [
        row
        for row in rows
        if row["metrics"] is not None
        and row["metrics"]["state"] <= level
        and (level >= 1e-2 or not (row["metrics"]["missed"] or row["metrics"]["false"]))
    ]
    return min(good, key=lambda row: row["seconds"]) if good else None


def scoreboard(cells: Rows) -> list[dict[str, Any]]:
    """For each case and level: the time of "auto", the best integrator of fricmb, the best peer."""
    board = []
    for case in dict.fromkeys(cell["case"] for cell in cells):
        mine = [cell for cell in cells if cell["case"] == case]
        for level in LEVELS:
            auto = fastest([cell for cell in mine if cell["method"] in ("auto", "solve_dae", "simulate")], level)
            own = fastest([cell for cell in mine if not cell["peer"]], level)
            peer = fastest([cell for cell in mine if cell["peer"]], level)
            board.append({"case": case, "level": level, "auto": auto, "own": own, "peer": peer})
    return board


#: A run is no dearer than the loosest of its scene up to so many times its steps.
NO_DEARER = 1.25
FREE = "more accurate than rtol, in as many steps as at the loosest tolerance"


def tolerance_statistic(cells: Rows) -> dict[str, Any]:
    """How often error / (rtol growth) of "auto" lies within its bounds, and the runs where it does not.

    ``fair``: with those that are more accurate than ``rtol`` at no cost, as where steps end at transitions or are exact
    in between.
    """
    runs, outside = 0, []
    fewest = {cell["case"]: _steps(cell) for cell in sorted(cells, key=_rtol) if cell["method"] == "auto"}
    for cell in cells:
        if cell["method"] != "auto" or cell["setting"]["rtol"] is None:
            continue
        runs += 1
        if cell["metrics"] is None:
            outside.append({**_named(cell), "ratio": None, "why": cell["failure"]})
            continue
        ratio = cell["metrics"]["grown"] / cell["setting"]["rtol"]
        if not LOW <= ratio <= HIGH:
            steps, least = _steps(cell), fewest[cell["case"]]
            free = ratio < LOW and steps is not None and least is not None and steps <= NO_DEARER * least
            why = FREE if free else "more accurate than rtol" if ratio < LOW else "less accurate than rtol"
            outside.append({**_named(cell), "ratio": ratio, "why": why})
    too_large = sum(row["ratio"] is None or row["ratio"] > HIGH for row in outside)
    return {
        "runs": runs,
        "within": (runs - len(outside)) / runs if runs else None,
        "not_above": (runs - too_large) / runs if runs else None,
        "fair": (runs - sum(row["why"] != FREE for row in outside)) / runs if runs else None,
        "exceptions": outside,
    }


def _steps(cell: dict[str, Any]) -> int | None:
    steps: int | None = cell.get("counters", {}).get("n_steps") if cell["metrics"] is not None else None
    return steps


def _rtol(cell: dict[str, Any]) -> float:
    return float(cell["setting"]["rtol"] or 0.0)


def _named(cell: dict[str, Any]) -> dict[str, Any]:
    return {"case": cell["case"], "rtol": cell["setting"]["rtol"], "used": cell["used"]}
