"""The certified references of ``tests/data`` as problems of the oracle."""

from __future__ import annotations

from typing import Any

import numpy as np

from .problem import Contact, Problem


def constant(value: float) -> Any:
    """That value whatever the arguments."""
    return lambda *_: value


def cone(name: str, W: Any, mu: Any, mu_s: float, N: float = 1.0, belt: float = 0.0) -> Contact:
    """A contact of constant load."""
    return Contact(name=name, W=np.atleast_2d(W), N=constant(N), mu=mu, mu_s=constant(mu_s), slide=constant(belt))


def problem(name: str, reference: dict[str, Any], t_end: float | None = None) -> Problem:
    """The problem of that reference."""
    info = reference["info"]
    end = float(reference["t"][-1]) if t_end is None else t_end
    makers = {"p1": brake, "p2": belt, "p3": oscillator, "p4": blocks, "p5": plane, "p6": blocks}
    return makers[name[:2]](name, info, end)


def brake(name: str, info: dict[str, Any], end: float) -> Problem:
    """The 4-dof brake."""
    p = {key: float(value) for key, value in info["params"].items()}
    R = float(info["R"])
    W = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    assert p["fk"] == p["fs"]
    return Problem(
        M=np.diag([1.0, 1.0, R, R]), K=np.diag([1.0, p["O1"] ** 2, 0.0, R * p["O2"] ** 2]),
        C=np.diag([p["d"], p["d"], 0.0, R * p["d"]]), q=np.zeros(4), v=np.array([float(x) for x in info["v0"]]),
        contacts=(cone("lining", W, constant(p["fk"]), p["fs"]),), t_end=end, scale=10.0,
    )  # fmt: skip


def belt(name: str, info: dict[str, Any], end: float) -> Problem:
    """A mass on a belt."""
    p = info["params"]
    mu = constant(1.0) if p["law"] == "coulomb" else lambda r, N: 1.0 + 0.5 * np.exp(-r / 0.05)
    one = np.ones((1, 1))
    return Problem(
        M=one, K=one, C=float(p["c"]) * one, q=np.zeros(1), v=np.array([0.1]),
        contacts=(cone("sole", one, mu, 1.5, belt=0.1),), t_end=end,
    )  # fmt: skip


def oscillator(name: str, info: dict[str, Any], end: float) -> Problem:
    """An oscillator with dry friction, free or forced."""
    one = np.ones((1, 1))
    free = name.startswith("p3_free")
    x0, friction, w = (float(name[8:]), 0.1, 0.0) if free else (0.0, 0.2, float(name.split("_w")[1].split("_")[0]))
    load = (lambda t: 0.0) if free else (lambda t: 0.5 * np.cos(w * t))
    return Problem(
        M=one, K=one, C=0.0 * one, q=np.array([x0]), v=np.zeros(1), load=load,
        contacts=(cone("sole", one, constant(friction), friction),), t_end=end,
    )  # fmt: skip


def blocks(name: str, info: dict[str, Any], end: float) -> Problem:
    """Blocks on a belt."""
    def mu_of(law: list[str]) -> Any:
        if law[0] == "coulomb":
            return constant(float(law[1]))
        return lambda r, N: float(law[1]) / (1.0 + float(law[2]) * r)

    def numbers(key: str) -> np.ndarray:
        return np.array(info[key], dtype=float)

    W = numbers("W")
    contacts = tuple(
        cone(f"c{i}", W[:, i : i + 1], mu_of(law), float(mu_s), belt=float(b))
        for i, (law, mu_s, b) in enumerate(zip(info["law"], info["mus"], info["b"], strict=True))
    )
    return Problem(
        M=numbers("M") if np.ndim(info["M"][0]) else np.diag(numbers("M")), K=numbers("K"), C=numbers("C"),
        q=numbers("q0"), v=numbers("v0"), contacts=contacts, t_end=end,
    )  # fmt: skip


def plane(name: str, info: dict[str, Any], end: float) -> Problem:
    """A unit mass on a plane."""
    mu, two = float(info["mu"]), np.eye(2)
    return Problem(
        M=two, K=np.diag([1.0, 2.3]), C=0.0 * two, q=np.array(info["q0"], dtype=float),
        v=np.array(info["v0"], dtype=float), contacts=(cone("sole", two, constant(mu), mu),), t_end=end,
    )  # fmt: skip
