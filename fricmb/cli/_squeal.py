"""``fricmb squeal``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.cli._load import load
from fricmb.cli._output import make_folder
from fricmb.errors import SceneError


def squeal(options: argparse.Namespace) -> int:
    """Study the stability of steady sliding; write a report and tables."""
    over = dict(_range(text) for text in options.over)
    speeds = dict(_number("--speed", text) for text in options.speed)
    uncertain = dict(_spread(text) for text in options.uncertain)
    if not over:
        raise SceneError("--over is missing: expected NAME=FIRST:LAST:COUNT, once or twice")
    loaded = load(options.model, case=options.case, values=options.values)
    folder = options.out or Path("fricmb-out") / f"{loaded.label}-squeal"
    make_folder(folder)
    study = fm.squeal.study(
        loaded.scene, over=over, speeds=speeds or None, highest=options.highest, workers=options.workers,
        store=options.store, progress=not options.quiet,
    )  # fmt: skip
    _ask(study, options, uncertain)
    written = study.write(folder)
    if not options.quiet:
        print(study)
        for answer in study.answered:
            if not isinstance(answer, tuple):
                print(f"\n{answer}")
        print(f"\nwritten      {folder}/: {', '.join(path.name for path in written)}")
    return 0


def _ask(study: Any, options: argparse.Namespace, uncertain: dict[str, Any]) -> None:
    """What is asked on the command line, and what feeds the mode that grows most."""
    grows = bool((study.map.unstable > 0).any())
    if not study.scene.is_mechanism:
        if grows and float(study.map.frequency.flat[np.nanargmax(study.map.growth)]) > 0.0:
            study.feed()
        if study.thresholds and study.thresholds[0].frequency > 0.0:
            study.derivatives(study.thresholds[0])
    if options.growth:
        study.growth()
    if options.saturation:
        study.saturation()
    if uncertain:
        study.uncertainty(uncertain, samples=options.samples)


def _range(text: str) -> tuple[str, Any]:
    """``NAME=FIRST:LAST:COUNT`` or ``NAME=A,B,C``."""
    name, equals, value = text.partition("=")
    try:
        if ":" in value:
            first, last, count = value.split(":")
            return _named(name, equals), np.linspace(float(first), float(last), int(count))
        return _named(name, equals), [float(one) for one in value.split(",")]
    except ValueError:
        raise SceneError(f"--over: expected NAME=FIRST:LAST:COUNT or NAME=A,B,C; got {text!r}") from None


def _number(option: str, text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    try:
        return _named(name, equals), float(value)
    except ValueError:
        raise SceneError(f"{option}: expected NAME=NUMBER; got {text!r}") from None


def _spread(text: str) -> tuple[str, Any]:
    """``NAME=0.05``, a relative standard deviation, or ``NAME=LOW:HIGH``."""
    name, equals, value = text.partition("=")
    try:
        if ":" in value:
            low, high = map(float, value.split(":"))
            return _named(name, equals), (low, high)
        return _named(name, equals), float(value)
    except ValueError:
        raise SceneError(f"--uncertain: expected NAME=SHARE or NAME=LOW:HIGH; got {text!r}") from None


def _named(name: str, equals: str) -> str:
    if not (name and equals):
        raise ValueError
    return name.strip()
