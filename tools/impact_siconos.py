"""The scenes of ``impact_error.py`` by Siconos, Debian's python3-siconos: ``python3 tools/impact_siconos.py [file]``.

Moreau and Jean's time stepping, theta = 1/2, the package's own linear complementarity and friction solvers; loads that
vary are handed over at the middle of each step, so that the scheme keeps its second order where nothing is hit.  Dry
friction is a contact pressed by a constant load, as the package has no other beside impacts; more friction at rest than
in slip it does not know, and the block between stops is left out.  Prints rows as ``impact_error.py`` writes them.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

STEPS = [1e-2, 1e-3, 1e-4, 1e-5]
G = 9.81


def linear(q: list[float], v: list[float]) -> Any:
    """Unit masses."""
    import siconos.kernel as sk

    return sk.LagrangianLinearTIDS(q, v, np.eye(len(q)))


def stepping(body: Any, contacts: list[tuple[Any, Any]], problem: Any, t_end: float, h: float) -> Any:
    """A simulation of a body with contacts (rows with their offsets, law)."""
    import siconos.kernel as sk

    model = sk.NonSmoothDynamicalSystem(0.0, t_end)
    model.insertDynamicalSystem(body)
    for (rows, offset), law in contacts:
        model.link(sk.Interaction(law, sk.LagrangianLinearTIR(np.array(rows), np.array(offset))), body)
    return sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), sk.MoreauJeanOSI(0.5), problem), model


def ball(h: float) -> list[float]:
    """Height at 3.5 s."""
    import siconos.kernel as sk

    body = linear([1.0], [0.0])
    body.setFExtPtr(np.array([-G]))
    steps, _model = stepping(body, [(([[1.0]], [0.0]), sk.NewtonImpactNSL(0.8))], sk.LCP(), 3.5, h)
    for _ in range(round(3.5 / h)):
        steps.computeOneStep()
        steps.nextStep()
    return [float(body.q()[0])]


def table(h: float) -> list[float]:
    """Height half a period behind 20 impacts; computed in the frame of the table."""
    import siconos.kernel as sk

    A, w, phase, v = 1e-3, 100.0, 1.221290450550073, 0.3081902393171587
    t_end = 20.5 * 2 * math.pi / w
    n = round(t_end / h)
    h = t_end / n
    body, load = linear([0.0], [v - A * w * math.cos(phase)]), np.zeros(1)
    body.setFExtPtr(load)
    steps, _model = stepping(body, [(([[1.0]], [0.0]), sk.NewtonImpactNSL(0.8))], sk.LCP(), t_end, h)
    for i in range(n):
        load[0] = -G + A * w * w * math.sin(w * (i + 0.5) * h + phase)
        body.setFExtPtr(load)  # takes a copy
        steps.computeOneStep()
        steps.nextStep()
    return [float(body.q()[0]) + A * math.sin(w * t_end + phase)]


def pendulum(h: float) -> list[float]:
    """Time and speed of the fourth impact; beside the angle a mass that is pressed on the dry pin."""
    import siconos.kernel as sk

    tau, stop, e = 0.6, 0.3, 0.7
    body, load, hits = linear([1.4, 0.0], [0.0, 0.0]), np.array([0.0, -tau]), []
    body.setFExtPtr(load)
    contacts = [
        (([[0.0, 1.0], [1.0, 0.0]], [0.0, 0.0]), sk.NewtonImpactFrictionNSL(0.0, 0.0, 1.0, 2)),
        (([[1.0, 0.0], [0.0, 1.0]], [-stop, 0.0]), sk.NewtonImpactFrictionNSL(e, 0.0, 0.0, 2)),
    ]
    steps, _model = stepping(body, contacts, sk.FrictionContact(2), 9.0, h)
    i = 0
    while len(hits) < 4 and i * h < 4.0:
        q, v = float(body.q()[0]), float(body.velocity()[0])
        load[0] = -G * math.sin(q + 0.5 * h * v)
        body.setFExtPtr(load)
        steps.computeOneStep()
        steps.nextStep()
        i += 1
        if v < 0.0 < float(body.velocity()[0]) and q < stop + 0.1:
            hits.append([i * h, -v])
    return hits[-1]


#: What is certified (tests/impacts/test_certified.py), as in ``impact_error.py``.
def height() -> float:
    """Of the ball, by parabolas."""
    v = math.sqrt(2 * G)
    t = v / G
    while t + 2 * 0.8 * v / G < 3.5:
        v *= 0.8
        t += 2 * v / G
    left = 3.5 - t
    return 0.8 * v * left - G * left**2 / 2


CASES = {
    "bouncing ball": (ball, [height()]),
    "oscillating table": (
        table,
        [1e-3 * math.sin(1.221290450550073) + 0.3081902393171587 * math.pi / 100 - G * (math.pi / 100) ** 2 / 2],
    ),
    "pendulum on a stop, dry pin": (pendulum, [2.526883944505081, 0.8360195141302381]),
}


def main() -> None:
    """Print rows, and with a file's name put them into it in place of those that are there."""
    rows = []
    for name, (run, exact) in CASES.items():
        for h in STEPS:
            times = []
            for _ in range(3 if h > 2e-5 else 1):
                start = time.process_time()
                found = run(h)
                times.append(time.process_time() - start)
            off = max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(found, exact, strict=True))
            row = {"scene": name, "way": "Siconos", "h": h, "error": float(f"{off:.1e}")}
            rows.append(row | {"ms": float(f"{1e3 * min(times):.3g}")})
            print(json.dumps(rows[-1]), flush=True)
    if len(sys.argv) > 1:
        path = Path(sys.argv[1])
        kept = [row for row in json.loads(path.read_text()) if row["way"] != "Siconos"]
        path.write_text("[\n" + ",\n".join(json.dumps(row) for row in [*kept, *rows]) + "\n]\n")


if __name__ == "__main__":
    main()
