"""Stability: regions of the formulas, vibration that steps do not resolve, stiff and extreme scenes."""

from fricmb.bench.stability._extreme import Extreme
from fricmb.bench.stability._grid import judge, run_stability, scenes
from fricmb.bench.stability._report import stability_body, stability_report

__all__ = ["Extreme", "judge", "run_stability", "scenes", "stability_body", "stability_report"]
