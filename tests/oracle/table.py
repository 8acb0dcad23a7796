"""Every law in motion: six situations of one mass (a disc where the law has three directions)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy

import fricmb as fm
from fricmb import laws

from .judge import Case
from .laws import parts_of
from .problem import Contact, Problem

METHODS = ("auto", "bdf", "radau", "collocation", "taylor")

#: Instances with scales of order 1, so that the oracle's explicit steps resolve everything; all others are examples.
_STRIBECK = laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1)
LAWS: dict[str, Any] = {
    "Ambrosio": laws.Ambrosio(mu=0.4, v_0=1e-3, v_1=1e-2),
    "ArctanRegularised": laws.ArctanRegularised(mu=0.4, v_reg=1e-2),
    "BengisuAkay": laws.BengisuAkay(mu_s=0.6, mu_k=0.4, v_reg=1e-2, decay=20.0),
    "BlimanSorine": laws.BlimanSorine(f1=0.7, f2=0.3, distance=0.02, eta=0.2),
    "BoucWen": laws.BoucWen(mu=0.3, stiffness=200.0, exponent=2.0, beta=0.5),
    "Bristle": laws.Bristle(law=_STRIBECK, stiffness=200.0, damping=2.0),
    "BrownMcPhee": laws.BrownMcPhee(mu_s=0.6, mu_k=0.4, v_t=1e-2),
    "Contensou": laws.Contensou(mu=0.4, v_reg=1e-2),
    "ContensouPade": laws.ContensouPade(mu=0.4, v_reg=1e-2),
    "Dahl": laws.Dahl(sigma0=200.0, mu=0.5),
    "ElastoPlastic": laws.ElastoPlastic(
        sigma0=200.0, sigma1=2.0, sigma2=0.1, mu_s=0.4, mu_k=0.3, v_s=0.1, elastic=0.7
    ),
    "GeneralisedMaxwellSlip": laws.GeneralisedMaxwellSlip(
        stiffness=(200.0, 150.0, 100.0), shares=(0.2, 0.3, 0.5), attraction=5.0, mu_s=0.4, mu_k=0.3, v_s=0.1, corner=0.1
    ),
    "Gonthier": laws.Gonthier(sigma0=200.0, sigma1=2.0, sigma2=0.05, mu_s=0.4, mu_k=0.3, v_s=0.05, tau_dwell=1.0),
    "Iwan": laws.Iwan(stiffness=(200.0, 150.0, 100.0), limits=(0.1, 0.15, 0.2), corner=0.1),
    "Jenkins": laws.Jenkins(stiffness=200.0, mu=0.3, corner=0.1),
    "Karnopp": laws.Karnopp(mu_s=0.6, mu_k=0.4, v_band=1e-2, stiffness=500.0, damping=30.0),
    "Leuven": laws.Leuven(
        stiffness=(200.0, 150.0, 100.0), limits=(0.1, 0.15, 0.3), mu_s=0.4, mu_k=0.3, v_s=0.1, sigma1=1.0, corner=0.1
    ),
    "LinearRegularised": laws.LinearRegularised(mu=0.4, v_reg=1e-2),
    "LuGre": laws.LuGre(sigma0=200.0, sigma1=0.0, sigma2=0.1, mu_s=0.6, mu_k=0.4, v_s=0.1),
    "Makkar": laws.Makkar(g1=0.25, g2=50.0, g3=5.0, g4=0.4, g5=50.0, g6=0.01),
    "RateAndState": laws.RateAndState(mu_0=0.6, a=0.02, b=0.03, L=0.02, v_0=0.01, v_rest=1e-3),
    "Regularised": laws.Regularised(law=_STRIBECK, v_reg=1e-2),
    "SquareRootRegularised": laws.SquareRootRegularised(mu=0.4, v_reg=1e-2),
    "TanhRegularised": laws.TanhRegularised(mu=0.4, v_reg=1e-2),
    "Threlfall": laws.Threlfall(mu=0.4, v_reg=1e-2),
    **{
        name: getattr(laws, name).example()
        for name in ("Coulomb", "CoulombViscous", "Cubic", "Elliptic", "FlashHeating", "HyperbolicStribeck",
                     "LoadDependent", "Logarithmic", "Lorentzian", "Offset", "Stribeck", "Tabulated")
    },
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Situation:
    """A spring, a damper, a belt, a load along the first direction and N, in units of the sliding friction."""

    k: float
    c: float
    belt: float
    load: Callable[[Any, Any], Any]
    """of t and the functions' home: ``math`` for numbers, ``sympy`` for scenes."""
    t_end: float
    q: float = 0.0
    v: float = 0.0
    varies: float = 0.0


SITUATIONS = {
    "reversal": Situation(k=4.0, c=0.0, belt=0.0, load=lambda t, f: 3.0 * f.sin(1.3 * t), t_end=9.0),
    "stick-slip": Situation(k=1.0, c=0.05, belt=0.2, load=lambda t, f: 0.0 * t, t_end=14.0, q=0.5, v=0.2),
    "steady sliding under vibration": Situation(
        k=4.0, c=0.0, belt=1.0, load=lambda t, f: 0.3 * f.sin(5.0 * t), t_end=5.0, q=0.2
    ),
    "break-away": Situation(k=1.0, c=0.5, belt=0.0, load=lambda t, f: 0.7 * t, t_end=5.0),
    "long rest": Situation(
        k=1.0, c=0.5, belt=0.0, load=lambda t, f: 0.4 * (1.0 - f.exp(-t)) - 0.3 * f.sin(0.5 * t), t_end=20.0
    ),
    "reversal under a varying load": Situation(
        k=4.0, c=0.0, belt=0.0, load=lambda t, f: 3.0 * f.sin(1.3 * t), t_end=9.0, varies=0.3
    ),
}


def dimension(name: str) -> int:
    """Directions of its row: one, unless the law is about more."""
    return 2 if name == "Elliptic" else min(LAWS[name].dimensions)


def case(name: str, situation: str) -> Case:
    """The scene and the numbers of one cell row."""
    law, s, d = LAWS[name], SITUATIONS[situation], dimension(name)
    N0 = 1.0 / float(law.coefficient(0.3, 1.0))
    made = parts(s, d)
    return Case(
        name=f"{name}, {situation}", scene=scene(law, s, N0, *made), problem=numbers(law, s, N0, *made),
        signals=tuple(f"m.mode{i + 1}" for i in range(d)),
    )  # fmt: skip


def parts(s: Situation, d: int) -> tuple[Any, ...]:
    """Shares of the loads, start, masses and springs of d directions."""
    # beside the first direction a little of the others, so that directions turn
    share = np.array([1.0, 0.2, 0.1])[:d]
    q, v = s.q * share, s.v * np.eye(d)[0] + (0.05 * np.eye(d)[-1] if d > 1 else 0.0)
    return share, q, v, np.array([1.0, 1.0, 0.5])[:d], s.k * np.array([1.0, 1.3, 0.8])[:d]


def scaled(name: str, situation: str, by: float) -> Any:
    """The scene of a cell under another normal force."""
    law, s, d = LAWS[name], SITUATIONS[situation], dimension(name)
    return scene(law, s, by / float(law.coefficient(0.3, 1.0)), *parts(s, d))


def scene(law: Any, s: Situation, N0: float, share: Any, q: Any, v: Any, masses: Any, k: Any) -> Any:
    """As fricmb has it."""
    d = len(q)
    axes = "xyz"[:d]
    body = fm.ModalBody(
        "m", frequencies=(0.0,) * d, damping_ratios=0.0, masses=tuple(masses), axes=axes, shapes={"sole": np.eye(d)},
        position={f"mode{i + 1}": q[i] for i in range(d)}, velocity={f"mode{i + 1}": v[i] for i in range(d)},
    )  # fmt: skip
    sole, parts = body.point("sole"), [body]
    for i, axis in enumerate(axes):
        parts.append(fm.Spring(f"k{axis}", sole, axis=axis, stiffness=k[i]))
        parts.append(fm.Damper(f"c{axis}", sole, axis=axis, damping=s.c))
        parts.append(fm.Force(f"f{axis}", sole, axis=axis, value=share[i] * s.load(fm.t, sympy)))
    load = N0 * (1 + s.varies * sympy.sin(2 * fm.t)) if s.varies else N0
    belt = fm.Driven("belt", velocity={"x": s.belt})
    parts += [belt, fm.Contact("sole", sole, belt, law=law, normal_force=load, axes=axes)]
    return fm.Scene("cell", parts)


def numbers(law: Any, s: Situation, N0: float, share: Any, q: Any, v: Any, masses: Any, k: Any) -> Problem:
    """As the oracle has it."""
    import math

    d = len(q)
    said = parts_of(law, d)
    W = np.eye(d) * said.pop("stretch", np.ones(d))
    belt = W.T @ (s.belt * np.eye(d)[0])
    centre = np.array(law.offsets() or (0.0,) * d, dtype=float)

    def N(t: float) -> float:
        return N0 * (1.0 + s.varies * math.sin(2.0 * t))

    contact = Contact(
        name="sole", W=W, N=lambda t, q, v: N(t), slide=lambda t: belt,
        constant=s.varies == 0.0, **said,
    )  # fmt: skip
    return Problem(
        M=np.diag(masses), K=np.diag(k), C=s.c * np.eye(d), q=np.array(q, dtype=float), v=np.array(v, dtype=float),
        load=lambda t: share * s.load(t, math) - centre * N(t), contacts=(contact,), t_end=s.t_end,
    )  # fmt: skip
