"""What the interpreter that has Siconos runs: numpy and Siconos alone.  ``python _siconos_run.py IN.npz OUT.npz``.

x' = A x + b(t) + B lambda, y = C x + e, -lambda in the relay of y with |lambda| <= limit; the theta-method with
theta = 1/2 and one relay problem a step (EulerMoreauOSI, TimeStepping).
"""

import sys
import time

import numpy as np


def main(source: str, target: str) -> None:
    """Read the problem, step through it, write states and forces at every ``every``-th step."""
    import siconos.kernel as sk

    given = np.load(source)
    h, count, every = float(given["h"]), int(given["count"]), int(given["every"])
    loads, limits = given["loads"], given["limits"]
    system = sk.FirstOrderLinearTIDS(given["start"], given["A"], loads[0])
    b = sk.SiconosVector(loads[0].size)
    for i, load in enumerate(loads[0]):
        b.setValue(i, load)
    system.setbPtr(b)
    moving = np.flatnonzero(np.ptp(loads, axis=0))
    model = sk.NonSmoothDynamicalSystem(0.0, (count + 0.5) * h)
    model.insertDynamicalSystem(system)
    relation = sk.FirstOrderLinearTIR(given["C"], given["B"])
    relation.setePtr(given["e"].copy())
    contact = sk.Interaction(sk.RelayNSL(len(limits), -1.0, 1.0), relation)
    model.link(contact, system)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), 1)
    simulation.insertIntegrator(sk.EulerMoreauOSI(0.5))
    simulation.insertNonSmoothProblem(sk.Relay())
    states = [given["start"].copy()]
    forces = [np.full(len(limits), np.nan)]
    begin = time.process_time()
    for i in range(count):
        for k in moving:
            b.setValue(int(k), loads[i, k])
        simulation.computeOneStep()
        if (i + 1) % every == 0:
            states.append(np.array(system.x()))
            forces.append(np.array(contact.lambda_(0)) * limits)
        simulation.nextStep()
    seconds = time.process_time() - begin
    np.savez(target, states=np.array(states), forces=np.array(forces), seconds=seconds)


if __name__ == "__main__":
    main(*sys.argv[1:3])
