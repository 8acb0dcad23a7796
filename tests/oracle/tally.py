"""What a run of many scenes found, as numbers for a page."""

from __future__ import annotations

import datetime
import json
import platform
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm

from .judge import BAR, Verdict
from .shrink import BAD

VERDICTS = ("right", "noted", "wrong", "stopped", "late", "crashed", "refused", "marginal")


class Tally:
    """Verdicts by method, and what failed."""

    def __init__(self, rtol: float, seed: int) -> None:
        self.about = {
            "date": datetime.date.today().isoformat(), "machine": platform.machine(), "fricmb": fm.__version__,
            "rtol": rtol, "bar": BAR, "seed": seed,
        }  # fmt: skip
        self.scenes: dict[str, dict[str, int]] = {}
        self.verdicts: dict[str, list[Verdict]] = {}
        self.failures: list[dict[str, Any]] = []

    def scene(self, kind: str, outcome: str) -> None:
        """One more scene: judged, marginal, or undecided by the oracle."""
        counts = self.scenes.setdefault(kind, {"judged": 0, "marginal": 0, "undecided": 0})
        counts[outcome] += 1

    def run(self, method: str, verdict: Verdict, where: dict[str, Any]) -> None:
        """One more run."""
        self.verdicts.setdefault(method, []).append(verdict)
        if verdict.kind in BAD:
            self.failures.append({
                **where, "method": method, "verdict": verdict.kind, "ratio": round(verdict.ratio, 3),
                "wrong_transitions": verdict.wrong_transitions, "why": verdict.why,
            })  # fmt: skip

    def methods(self) -> dict[str, dict[str, Any]]:
        """Counts, the worst and the 99th percentile of error over rtol and growth, transitions wrong."""
        out = {}
        for method, found in self.verdicts.items():
            ratios = [v.ratio for v in found if v.kind in ("right", "noted", "wrong")]
            out[method] = {
                **{kind: sum(v.kind == kind for v in found) for kind in VERDICTS},
                "worst": max(ratios, default=None),
                "percentile_99": float(np.percentile(ratios, 99)) if ratios else None,
                "wrong_transitions": sum(v.wrong_transitions for v in found),
            }
        return out

    def data(self, minutes: float) -> dict[str, Any]:
        """For JSON."""
        return {
            "about": {**self.about, "minutes": round(minutes, 1)}, "scenes": self.scenes, "methods": self.methods(),
            "failures": self.failures,
        }  # fmt: skip

    def save(self, path: Path, minutes: float) -> None:
        """Write it."""
        path.write_text(json.dumps(self.data(minutes), indent=1) + "\n")

    def text(self) -> str:
        """For the terminal."""
        tried = sum(sum(counts.values()) for counts in self.scenes.values())
        judged = sum(counts["judged"] for counts in self.scenes.values())
        lines = [f"{tried} scenes tried, {judged} judged, {len(self.failures)} runs failed", ""]
        head = ("method", *VERDICTS, "worst", "99 %", "wrong transitions")
        lines.append("  ".join(f"{name:>12}" for name in head))
        for method, row in self.methods().items():
            numbers = [f"{row[kind]}" for kind in VERDICTS]
            numbers += ["-" if row[key] is None else f"{row[key]:.2g}" for key in ("worst", "percentile_99")]
            lines.append("  ".join(f"{name:>12}" for name in (method, *numbers, row["wrong_transitions"])))
        return "\n".join(lines)
