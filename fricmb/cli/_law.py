"""``fricmb law``."""

from __future__ import annotations

import argparse

import numpy as np

import fricmb as fm
from fricmb.cli._load import setting
from fricmb.cli._output import make_folder
from fricmb.errors import LawError, unknown_name


def find_law(name: str) -> type[fm.FrictionLaw]:
    """A law of the catalogue or of an installed package."""
    if name in fm.laws.names:
        kind: type[fm.FrictionLaw] = getattr(fm.laws, name)
        return kind
    found, broken = fm.laws.published("fricmb.friction_laws")
    if name in broken:
        raise LawError(f"law {name!r}: {broken[name]}")
    if name not in found:
        raise unknown_name("law", name, [*fm.laws.names, *found])
    published: type[fm.FrictionLaw] = found[name]
    return published


def show_law(options: argparse.Namespace) -> int:
    """Print the facts of a law and draw it."""
    law = find_law(options.law).example()
    changes = dict(setting(text) for text in options.values)
    if changes:
        law = law.with_slots(changes)
    if not (np.isfinite(options.normal_force) and options.normal_force > 0.0):
        raise LawError(f"--normal-force: expected a number > 0; got {options.normal_force:g}")
    print(law)
    if law.kind != "smooth":
        N = options.normal_force
        print(f"break-away {law.break_away(N):.6g}, slip for r -> 0 {law.slip_limit(N):.6g}; sticks")
        if law.offsets():
            centre = ", ".join(f"{-float(c):.6g}" for c in law.numeric().offsets())
            print(f"centre of the cone {centre}: friction differs by direction")
    else:
        creep = law.creep(0.5)
        print(
            f"break-away {creep.break_away:.6g}; under half of it: gives way by {creep.displacement:.3g},"
            f" creeps at {creep.velocity:.3g}"
        )
    if law.states:
        print(f"states in one direction: {', '.join(law.state_labels('xyz'[: law.dimensions[0]]))}")
    figure = fm.plot.law_figure(law, normal_force=options.normal_force)
    make_folder(options.out)
    target = options.out / f"{options.law}.{options.format}"
    figure.savefig(target, dpi=150)
    print(f"wrote {target}")
    return 0
