"""Measure what ``auto`` chooses by: its methods, and itself, on many scenes: time and error.

``python tools/choice_survey.py [out.json] [name ...]`` writes one row per scene, method and tolerance.  Times are
processor time of the second call or later, the best of three.  Errors are scaled by each signal's largest value and
taken against Radau at 1e-12 (``auto`` at 1e-11 where that stops), which the certified references of the tests confirm
on the scenes they cover.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.errors import FricmbError
from fricmb.integrate import integrators
from fricmb.system import build

models, laws = fm.models, fm.laws
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
METHODS: dict[str, Callable[[], Any]] = {
    **{name: integrators[name] for name in ("collocation", "bdf", "radau", "taylor")}, "auto": lambda: "auto",
}  # fmt: skip


def falling(n: int) -> fm.Scene:
    """Blocks on a belt under a falling coefficient."""
    each = [laws.Stribeck(mu_s=1.3 + 0.05 * i, mu_k=1.0, v_s=0.1) for i in range(n)]
    scene: fm.Scene = models.stick_slip_chain(n, laws=each)
    return scene


def in_the_plane(n: int, belt: float, mu_s: float) -> fm.Scene:
    """Masses on a belt in the plane, springs to the ground and between neighbours."""
    start = [{"x": 0.1 * math.sin(3 * i), "y": 0.9 * math.cos(5 * i)} for i in range(n)]
    bodies = [fm.Body(f"b{i}", mass=1.0, axes="xy", position=start[i]) for i in range(n)]
    drive = fm.Driven("belt", velocity={"x": belt})
    parts: list[Any] = []
    for axis, stiffness in (("x", 1.0), ("y", 1.7)):
        parts += [fm.Spring(f"g{i}{axis}", body, axis=axis, stiffness=stiffness) for i, body in enumerate(bodies)]
    for axis in "xy":
        parts += [fm.Spring(f"c{i}{axis}", bodies[i], bodies[i + 1], axis=axis, stiffness=5.0) for i in range(n - 1)]
    for i, body in enumerate(bodies):
        law = laws.Coulomb(mu_s=mu_s + 0.02 * i, mu_k=0.6 * mu_s)
        parts.append(fm.Contact(f"k{i}", body, drive, law=law, normal_force=1.0))
    return fm.Scene("masses in the plane", [*bodies, drive, *parts])


def beam(n: int, contacts: int = 1, damping: float = 1e-4) -> fm.Scene:
    """A row of masses of which few rub: many degrees of freedom, few ports."""
    bodies = [fm.Body(f"b{i}", mass=1.0) for i in range(n)]
    drive = fm.Driven("belt", velocity={"x": 0.5})
    parts: list[Any] = [fm.Spring("g", bodies[0], axis="x", stiffness=50.0)]
    parts += [fm.Spring(f"s{i}", bodies[i], bodies[i + 1], axis="x", stiffness=400.0) for i in range(n - 1)]
    parts += [fm.Damper(f"d{i}", bodies[i], bodies[i + 1], axis="x", damping=400.0 * damping) for i in range(n - 1)]
    law = laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.2)
    places = [n - 1 - (n // contacts) * k for k in range(contacts)]
    parts += [fm.Contact(f"c{i}", bodies[i], drive, law=law, normal_force=1.0) for i in places]
    return fm.Scene("beam", [*bodies, drive, *parts])


def tied(n: int, tie: float, damping: float = 0.0) -> fm.Scene:
    """Masses in a row, on a soft spring, tied to each other by stiff ones; the last one rubs."""
    bodies = [fm.Body(f"b{i}", mass=1.0, position={"x": 0.1 * (1 + i)}) for i in range(n)]
    drive = fm.Driven("belt", velocity={"x": 0.5})
    parts: list[Any] = [fm.Spring("g", bodies[0], axis="x", stiffness=1.0)]
    for i in range(n - 1):
        pair = bodies[i], bodies[i + 1]
        parts.append(fm.Spring(f"s{i}", *pair, axis="x", stiffness=tie))
        parts.append(fm.Damper(f"d{i}", *pair, axis="x", damping=2.0 * damping * math.sqrt(tie)))
    law = laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.2)
    return fm.Scene("tied", [*bodies, drive, *parts, fm.Contact("c", bodies[-1], drive, law=law, normal_force=1.0)])


def pad(contacts: int) -> fm.Scene:
    """A body by its modes, pressed on a disc at many points."""
    rng, modes = np.random.default_rng(1), max(40, 2 * contacts + 8)
    shapes = {f"p{i}": rng.normal(size=(2, modes)) for i in range(contacts)}
    omega = 2.0 * np.pi * np.linspace(300.0, 6000.0, modes)
    body = fm.ModalBody("pad", frequencies=omega, damping_ratios=0.005, shapes=shapes, axes="xy")
    disc, law = fm.Driven("disc", velocity={"x": 0.02, "y": 0.003}), laws.Coulomb(mu_s=0.6, mu_k=0.4)
    rubs = [fm.Contact(f"c{i}", body.point(f"p{i}"), disc, law=law, normal_force=20.0) for i in range(contacts)]
    return fm.Scene("pad", [body, disc, *rubs])


def elements(contacts: int, nodes: int = 60) -> fm.Scene:
    """A bar of linear finite elements, whose mass matrix couples; some of its nodes rub."""
    unit = np.array([[1.0, -1.0], [-1.0, 1.0]])
    M, K = np.zeros((2, nodes, nodes))
    for e in range(nodes - 1):
        M[e : e + 2, e : e + 2] += (np.abs(unit) + np.eye(2)) / (6.0 * nodes)
        K[e : e + 2, e : e + 2] += unit * nodes
    K[0, 0] += 5.0
    bodies, drive = [fm.Body(f"x{i}", mass=1e-3 / nodes) for i in range(nodes)], fm.Driven("belt", velocity={"x": 0.05})
    matrices = fm.MatrixElement("bar", [f"x{i}.x" for i in range(nodes)], M=M, C=1e-3 * K + 0.05 * M, K=K)
    law = laws.Stribeck(mu_s=1.2, mu_k=0.8, v_s=0.1)
    places = np.linspace(nodes // 6, nodes - 1, contacts).round().astype(int)
    rubs = [fm.Contact(f"c{i}", bodies[i], drive, law=law, normal_force=1.0 / contacts) for i in places]
    return fm.Scene("bar", [*bodies, drive, matrices, *rubs])


def belt(law: fm.FrictionLaw) -> fm.Scene:
    """The mass on a belt under any law."""
    scene: fm.Scene = models.belt_oscillator(law=law)
    return scene


def scenes() -> dict[str, tuple[Callable[[], fm.Scene], float]]:
    """Scenes by name, with the length of their run."""
    found: dict[str, tuple[Callable[[], fm.Scene], float]] = {
        "brake, case 1": (partial(models.brake4dof, "1"), 700.0),
        "brake, case 2": (partial(models.brake4dof, "2"), 700.0),
        "brake, case 5": (partial(models.brake4dof, "5"), 700.0),
        "brake, Stribeck": (partial(models.brake4dof, "2", law=laws.Stribeck(mu_s=1.2, mu_k=0.8, v_s=1.0)), 100.0),
        "belt": (models.belt_oscillator, 200.0),
        "belt, Stribeck": (partial(belt, laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05, exponent=1.0)), 200.0),
        "belt, viscous": (partial(belt, laws.CoulombViscous(mu_s=1.5, mu_k=1.0, viscous=0.1)), 60.0),
        "belt, table": (partial(belt, laws.Tabulated(speed=[0, 0.05, 0.1, 0.5, 2], mu=[1.5, 1.2, 1.1, 1, 1])), 60.0),
        "belt, tanh": (partial(belt, laws.TanhRegularised(mu=1.0, v_reg=1e-2)), 60.0),
        "belt, Dahl": (partial(belt, laws.Dahl(mu=1.0, sigma0=1e3)), 60.0),
        "forced": (partial(models.friction_oscillator, friction=0.2, amplitude=0.5, frequency=0.8), 100.0),
        "planar": (partial(models.planar_oscillator, friction=0.1, position=(2.0, 0.0), velocity=(0.0, 1e-2)), 40.0),
        "flutter": (models.minimal_flutter, 60.0),
        "stack of 3": (models.block_stack, 3.0),
    }
    found |= {f"blocks, {n}": (partial(models.stick_slip_chain, n), 20.0) for n in (2, 4, 8, 12, 16)}
    found |= {f"blocks, Stribeck, {n}": (partial(falling, n), 20.0) for n in (2, 3, 4, 6, 8)}
    found |= {f"sliding in the plane, {n}": (partial(in_the_plane, n, 0.3, 0.5), 20.0) for n in (1, 2, 4, 6, 8)}
    found |= {f"sticking in the plane, {n}": (partial(in_the_plane, n, 0.05, 0.9), 60.0) for n in (1, 2, 3, 4, 6)}
    found |= {f"beam, {n}": (partial(beam, n), 20.0) for n in (5, 20, 60, 150)}
    found |= {
        f"tied, {n}, {tie:g}, {damping}": (partial(tied, n, tie, damping), 10.0)
        for n, tie, damping in (
            (2, 1e2, 0.0), (2, 1e4, 0.0), (2, 1e4, 0.3), (4, 1e3, 0.0), (12, 1e2, 0.0), (12, 1e4, 0.0),
        )
    }
    found |= {
        "beam, 60, 4 contacts": (partial(beam, 60, 4), 20.0),
        "beam, 60, damped": (partial(beam, 60, 1, 0.05), 20.0),
    }
    found |= {f"pad, {n}": (partial(pad, n), 1e-3) for n in (4, 8, 12, 16, 24, 36)}
    found |= {f"elements, {n}": (partial(elements, n), 1.0) for n in (4, 8, 12, 16, 24, 36)}
    found |= {f"blocks, Stribeck, {n}": (partial(falling, n), 20.0) for n in (12, 16, 24, 36)}
    return found


def timed(scene: fm.Scene, t: np.ndarray, rtol: float, method: Any) -> tuple[fm.Solution, float]:
    """A run and its processor time in milliseconds."""
    begin = time.thread_time()
    sol = fm.simulate(scene, t_end=float(t[-1]), rtol=rtol, t_eval=t, method=method)
    return sol, 1e3 * (time.thread_time() - begin)


def measure(name: str, make: Callable[[], fm.Scene], t_end: float) -> list[dict[str, Any]]:
    """Rows of one scene."""
    scene, t = make(), np.linspace(0.0, t_end, 201)
    try:
        true, _ = timed(scene, t, 1e-12, integrators["radau"]())
    except FricmbError:
        true, _ = timed(scene, t, 1e-11, "auto")
    state = np.vstack([true.q, true.v])
    size = np.abs(state).max(axis=1)
    size[size < 1e-12] = 1.0
    problem = build(scene).problem
    chosen = {r: fm.simulate(scene, t_end=1e-6 * t_end, rtol=r).stats.method for r in TOLERANCES}
    found = []
    for rtol in TOLERANCES:
        for label, make_method in METHODS.items():
            row: dict[str, Any] = {
                "scene": name, "method": label, "rtol": rtol, "rows": problem.m, "n": problem.n,
                "auto": chosen[rtol],
            }  # fmt: skip
            try:
                runs = [timed(scene, t, rtol, make_method()) for _ in range(3)]
            except FricmbError as error:
                found.append(row | {"failure": " ".join(str(error).split())[:200]})
                continue
            sol = runs[-1][0]
            error = float((np.abs(np.vstack([sol.q, sol.v]) - state).max(axis=1) / size).max())
            row |= {"ms": round(min(ms for _, ms in runs), 3), "error": float(f"{error:.2e}")}
            found.append(row | {"steps": int(sol.stats.n_steps), "events": len(sol.events)})
    return found


def main() -> None:
    """Measure all scenes, or those named."""
    out = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/benchmark/choice.json")
    wanted = sys.argv[2:]
    rows: list[dict[str, Any]] = []
    for name, (make, t_end) in scenes().items():
        if not wanted or name in wanted:
            found = measure(name, make, t_end)
            rows += found
            print(
                name,
                *(f"{r['method']} {r['rtol']:.0e} {r.get('ms')} ms {r.get('error')}" for r in found),
                sep="\n  ",
            )
            out.write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")


if __name__ == "__main__":
    main()
