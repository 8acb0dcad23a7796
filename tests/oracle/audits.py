"""``python -m tests.oracle --audits``: what audits say of runs that the oracle finds right, and of wrong ones."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm

from .judge import Outcome, Truth, compare, truth
from .problem import OracleError
from .table import LAWS, SITUATIONS, scaled
from .table import case as cell
from .wrong import WAYS, against, smallest

#: Errors over rtol and growth between which runs are counted together.
DECADES = (0.0, 10.0, 100.0, 1e3, 1e4, np.inf)
#: Normal forces that are wrong by these shares make runs that are wrong by some known amount.
OFF = (1e-5, 1e-4, 1e-3, 1e-2)


class Audits:
    """Audits of the table's scenes: those right, those that alarm for nothing, those that miss."""

    def __init__(self, rtol: float) -> None:
        self.rtol = rtol
        self.about = {"date": time.strftime("%Y-%m-%d"), "fricmb": fm.__version__, "rtol": rtol}
        self.right = {"audits": 0, "passed": 0, "alarms": []}
        self.unjudged: list[dict[str, Any]] = []
        self.wrong = {f"{a:g} to {b:g}": {"runs": 0, "seen": 0} for a, b in pairwise(DECADES)}
        self.ways: dict[str, dict[str, Any]] = {}

    def scene(self, law: str, situation: str, methods: Iterable[str]) -> None:
        """One cell of the table, by each method; and with normal forces that are not those of the cell."""
        case = cell(law, situation)
        try:
            true = truth(case)
        except OracleError as error:
            self.unjudged.append({"law": law, "situation": situation, "why": str(error)})
            return
        if true.marginal:
            self.unjudged.append({"law": law, "situation": situation, "why": true.marginal})
            return
        for method in methods:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                sol = fm.simulate(case.scene, t_end=case.problem.t_end, rtol=self.rtol, method=method)
            verdict = self.error(true, sol)
            audit = sol.audit()
            where = {"law": law, "situation": situation, "method": method, "error": round(verdict, 3)}
            if verdict > DECADES[2]:
                self.add_wrong(verdict, audit.ok)
                continue
            self.right["audits"] += 1
            self.right["passed"] += audit.ok
            if not audit.ok:
                self.right["alarms"].append({**where, "check": str(audit.failed[0])})
        for off in OFF:
            other = fm.simulate(scaled(law, situation, 1.0 + off), t_end=sol.t_end, rtol=self.rtol, method="radau")
            error = self.error(true, other)
            self.add_wrong(error, against(other, sol).ok)

    def error(self, true: Truth, sol: Any) -> float:
        """Over rtol and the growth of errors; without end where transitions are others."""
        at, signals = sol.at(true.t), true.case.signals
        events = [(e.contact, e.kind) for e in sol.events]
        found = Outcome(
            "done", "", "", np.array([at[s] for s in signals]), np.array([at.velocity(s) for s in signals]), events
        )
        verdict = compare(true, found, self.rtol)
        return verdict.ratio if verdict.wrong_transitions == 0 else float(max(verdict.ratio, 1e3))

    def add_wrong(self, error: float, passed: bool) -> None:
        """A run of which the error is known."""
        for (a, b), row in zip(pairwise(DECADES), self.wrong.values(), strict=True):
            if a <= error < b:
                row["runs"] += 1
                row["seen"] += not passed

    def amounts(self) -> None:
        """From which amount on each way of being wrong is seen."""
        for name, way in WAYS.items():
            size, check, units = smallest(way)
            self.ways[name] = {"seen from": size, "by": check, "units": round(units, 1)}

    def data(self) -> dict[str, Any]:
        """For JSON."""
        alarms = len(self.right["alarms"])
        return {
            "about": self.about, "right runs": self.right, "false alarms": alarms / max(1, self.right["audits"]),
            "runs wrong by (error over rtol and growth)": self.wrong, "ways": self.ways, "unjudged": self.unjudged,
        }  # fmt: skip


def audit_all(rtol: float, laws: Iterable[str], minutes: float, path: Path | None) -> int:
    """The whole table by the general method and by what ``auto`` takes; exit status 1 where an audit was wrong."""
    audits, end = Audits(rtol), time.monotonic() + 60.0 * minutes
    audits.amounts()
    for law in laws or LAWS:
        for situation in SITUATIONS:
            if time.monotonic() > end:
                break
            audits.scene(law, situation, ("radau", "auto"))
            if path is not None:
                path.write_text(json.dumps(audits.data(), indent=1) + "\n")
    print(json.dumps(audits.data(), indent=1))
    return int(bool(audits.right["alarms"]))
