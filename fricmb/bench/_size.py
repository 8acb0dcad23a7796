"""Cost against size: chains of blocks with stick-slip, a body of many modes with one contact, chains of links."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import fricmb as fm
from fricmb import models
from fricmb.bench._cell import one_line
from fricmb.bench._fit import exponent
from fricmb.bench._reference import shipped
from fricmb.bench._smooth import smooth
from fricmb.bench._timed import timed
from fricmb.errors import FricmbError

RTOL = 1e-4


@dataclass(frozen=True, kw_only=True)
class SizeCase:
    """Scenes that grow: ``build(n)``, run to ``t_end``, at ``sizes``.

    ``per_step``: the motion is another one at every size, and what is compared is the time of an attempted step.
    """

    name: str
    title: str
    build: Callable[[int], fm.Scene]
    t_end: float
    sizes: tuple[int, ...]
    quick: int = 2
    per_step: bool = False


def modal_belt(n: int) -> fm.Scene:
    """A clamped bar by its first n longitudinal modes, its free end rubbing on a moving belt.

    Frequencies (2 k - 1) pi/2, damping ratio 0.002, unit modal masses, shapes of alternating sign at the end:
    stick-slip with a vibration of many modes after each release.
    """
    k = np.arange(1, n + 1)
    tip = math.sqrt(2.0) * np.where(k % 2 == 1, 1.0, -1.0)
    bar = fm.ModalBody(
        "bar", frequencies=(2 * k - 1) * math.pi / 2, damping_ratios=0.002, shapes={"tip": tip[None, :]}, axes="x"
    )
    belt = fm.Driven("belt", velocity={"x": 0.1})
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.6)
    sole = fm.Contact("sole", bar.point("tip"), belt, law=law, normal_force=1.0)
    return fm.Scene(f"bar of {n} modes", [bar, belt, sole])


def grid(n: int) -> fm.Scene:
    """About n blocks on a belt in a square, each tied to its four neighbours: as the chain, in two directions."""
    side = round(math.sqrt(n))
    blocks = [fm.Body(f"block{k}", mass=1.0, velocity={"x": 0.1}) for k in range(side * side)]
    belt = fm.Driven("belt", velocity={"x": 0.1})
    parts: list[Any] = [*blocks, belt]
    for k, block in enumerate(blocks):
        if (k + 1) % side:
            parts.append(fm.Spring(f"row{k}", block, blocks[k + 1], axis="x", stiffness=100.0))
        if k + side < len(blocks):
            parts.append(fm.Spring(f"column{k}", block, blocks[k + side], axis="x", stiffness=100.0))
        law = fm.laws.Coulomb(mu_s=1.2 + 0.1 * math.sin(7 * k), mu_k=1.0)
        parts.append(fm.Spring(f"ground{k}", block, axis="x", stiffness=1.0))
        parts.append(fm.Contact(f"sole{k}", block, belt, law=law, normal_force=1.0))
    return fm.Scene(f"grid of {side} x {side} blocks", parts)


def links(n: int) -> fm.Scene:
    """An open chain of n pinned links that starts level and swings down under its weight."""
    ends = {"a": (-0.5, 0.0), "b": (0.5, 0.0)}
    bars = [fm.RigidBody(f"l{i}", mass=1.0, inertia=1.0 / 12.0, position=(i + 0.5, 0.0), points=ends) for i in range(n)]
    held = [fm.ground_point(0.0, 0.0), *(bar.point("b") for bar in bars[:-1])]
    pins = [fm.Revolute(f"j{i}", bar.point("a"), end) for i, (bar, end) in enumerate(zip(bars, held, strict=True))]
    return fm.Scene(f"chain of {n} links", [*bars, *pins, fm.Gravity("weight")])


#: Of the rope on half a drum: coefficient, tension of the end that holds, stiffness of the whole, its mass.
_MU, _HELD, _STIFF, _MASS = 0.5, 10.0, 1e5, 0.1


def capstan(n: int) -> fm.Scene:
    """A rope on half a drum, pulled at one end by 10 + 10 t: n masses and springs; 1: the part.

    The contact of a mass is under the tension times the angle by which it turns.
    """
    if n == 1:
        a, b = (fm.Body(name, mass=_MASS / 2) for name in ("a", "b"))
        pulls = [
            fm.Force("hold", a, axis="x", value=_HELD), fm.Force("pull", b, axis="x", value=_HELD + 10.0 * fm.t),
        ]  # fmt: skip
        rope = fm.Rope("rope", (a, b), axes="xx", angle=math.pi, friction=_MU)
        return fm.Scene("rope on half a drum", [a, b, *pulls, rope])
    k, mass, turn = _STIFF * n, _MASS / n, 2 * math.sin(math.pi / n / 2)
    bits = [fm.Body(f"p{i}", mass=mass) for i in range(n)]
    x = [fm.coordinate(f"p{i}.x") for i in range(n)]
    tension = [_HELD, *(_HELD + k * (x[i + 1] - x[i]) for i in range(n - 1)), _HELD + 10.0 * fm.t]
    parts: list[Any] = [*bits, fm.Force("pull", bits[-1], axis="x", value=10.0 * fm.t)]
    for i in range(n):
        N = turn * (tension[i] + tension[i + 1]) / 2
        parts.append(fm.Contact(f"c{i}", bits[i], law=fm.laws.Coulomb(mu_s=_MU), normal_force=N, axes="x"))
    for i in range(n - 1):
        parts.append(fm.Spring(f"s{i}", bits[i], bits[i + 1], axis="x", stiffness=k))
        parts.append(fm.Damper(f"d{i}", bits[i], bits[i + 1], axis="x", damping=0.1 * math.sqrt(k * mass)))
    return fm.Scene(f"rope of {n} masses on half a drum", parts)


SIZES = (
    SizeCase(
        name="chain", title="chain of n blocks on a belt, t = 20", build=models.stick_slip_chain, t_end=20.0,
        sizes=(10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000),
    ),
    SizeCase(
        name="grid", title="square of n blocks on a belt, t = 14, one step", build=grid, t_end=14.0,
        sizes=(100, 400, 1600, 6400, 25_600), per_step=True,
    ),
    SizeCase(
        name="modes", title="bar of n modes with one contact, t = 20", build=modal_belt, t_end=20.0,
        sizes=(5, 16, 50, 160, 500, 1600, 5000),
    ),
    SizeCase(
        name="links", title="open chain of n pinned links, one step", build=links, t_end=0.5,
        sizes=(6, 12, 25, 50, 100, 200, 400), per_step=True,
    ),
    SizeCase(
        name="capstan", title="rope on half a drum pulled until it slips: one part (1), n masses and springs",
        build=capstan, t_end=4.2, sizes=(1, 4, 10, 30),
    ),
)  # fmt: skip


def size_methods(case: SizeCase) -> list[str]:
    """Integrators of variable step, and CVODE for the chain; for grids the one that is made for large scenes."""
    if case.name == "links":
        return ["auto", "bdf"]
    if case.name == "capstan":
        return ["auto"]
    if case.name == "grid":
        return ["taylor"]
    own = ["auto", *(name for name, kind in fm.integrators.items() if kind.adaptive)]
    return [*own, "CVODE"] if case.name == "chain" else own


def measure_size(name: str, method: str, n: int) -> dict[str, Any]:
    """One run at one size: seconds of the run alone and of building the scene, transitions, error where known."""
    case = next(case for case in SIZES if case.name == name)
    found: dict[str, Any] = {"case": name, "method": method, "n": n}
    try:
        begin = time.process_time()
        scene = case.build(n)
        found["build"] = time.process_time() - begin
        run = _cvode if method == "CVODE" else _own
        return found | run(case, scene, method, n)
    except (FricmbError, ArithmeticError, ValueError, RuntimeError, MemoryError) as error:
        return found | {"failure": one_line(error)}


def _own(case: SizeCase, scene: fm.Scene, method: str, n: int) -> dict[str, Any]:
    times = np.linspace(0.0, case.t_end, 41)
    fm.simulate(scene, t_end=case.t_end * 1e-4, rtol=RTOL, method=method)  # loads, plans
    sol, seconds = timed(lambda: fm.simulate(scene, t_end=case.t_end, rtol=RTOL, method=method, t_eval=times))
    if case.per_step:
        seconds /= sol.stats.n_steps + sol.stats.n_rejected
    return {
        "seconds": seconds, "events": len(sol.events), "steps": sol.stats.n_steps, "used": sol.stats.method,
        "energy": float(np.abs(sol.energy.residual).max()), "error": _error(case, n, sol.q),
    }  # fmt: skip


def _cvode(case: SizeCase, scene: fm.Scene, method: str, n: int) -> dict[str, Any]:
    """CVODE with a band, friction smoothed over slip speeds of 1e-4: about 1 % on the chain of 10."""
    from fricmb.bench._sundials import Cvode

    smoothed = smooth(scene, 1e-4, case.t_end)
    times = np.linspace(0.0, case.t_end, 41)
    begin = time.process_time()
    answer = Cvode().solve(smoothed, times, 1e-6, np.full(len(smoothed.start), 1e-8), steps=False)
    seconds = time.process_time() - begin
    return {"seconds": seconds, "used": "CVODE", "error": _error(case, n, smoothed.split(answer.y)[0])}


def _error(case: SizeCase, n: int, q: np.ndarray) -> float | None:
    if case.name != "chain" or n not in (10, 100):
        return None
    true = shipped(f"chain{n}").q
    return float((np.abs(q - true).max(axis=1) / np.abs(true).max(axis=1)).max())


def fits(rows: list[dict[str, Any]]) -> dict[str, float | None]:
    """Exponent of the cost for each case and method ("case/method"), over sizes of at least 50."""
    found: dict[str, float | None] = {}
    for key in dict.fromkeys((row["case"], row["method"]) for row in rows):
        mine = [row for row in rows if (row["case"], row["method"]) == key and row.get("seconds") and row["n"] >= 50]
        found["/".join(key)] = exponent([row["n"] for row in mine], [row["seconds"] for row in mine])
    return found
