"""Exudyn: generalized-alpha steps of a smoothed scene (an optional package)."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any

import numpy as np

from fricmb.bench._case import SceneCase
from fricmb.bench._method import Method
from fricmb.bench._peers import Answer, PeerError, Smoothed
from fricmb.bench._reference import Floats
from fricmb.bench._run import Run, Setting
from fricmb.bench._smooth import SmoothScene
from fricmb.system import build

#: Widths of the smoothing; in a step the motion passes through about one of it: a smaller one gained nothing.
WIDTHS = (1e-2, 1e-3, 1e-4)
#: Most steps of a run.
MOST = 2_000_000


@dataclass(frozen=True)
class Exudyn(Smoothed):
    """``ObjectGenericODE2`` with a user function of forces, solved by implicit steps of a fixed length.

    The user function is the compiled right-hand side; Exudyn differentiates it numerically.
    """

    step: float = 0.0
    name: str = "Exudyn"

    def settings(self, case: SceneCase, quick: bool) -> list[Setting]:
        """Widths with their steps."""
        q, v = (float(scale.max()) for scale in case.reference().scales)
        found = [Setting(eps=eps, step=eps * max(q / v, case.t_end / 1e4)) for eps in WIDTHS]
        return [setting for setting in found if setting.step is not None and case.t_end / setting.step <= MOST]

    def refuses(self, case: SceneCase) -> str | None:
        """Laws with states, beside what the smoothing cannot represent."""
        if build(case.build()).problem.n_z:
            return "states of laws are not part of the adapter"
        return super().refuses(case)

    def run(self, case: SceneCase, setting: Setting, *, detail: bool) -> Run:
        """See :class:`Method`."""
        stepped = replace(self, step=setting.step or 1e-3)
        return super(Exudyn, stepped).run(case, setting, detail=detail)

    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Steps that divide the spacing of ``t``; with ``steps`` every one is kept."""
        import exudyn

        warnings.simplefilter("ignore", DeprecationWarning)
        system, sensors = _system(scene)
        spacing = float(t[1] - t[0])
        count = max(1, round(spacing / self.step)) * round(float(t[-1] - t[0]) / spacing)
        options = exudyn.SimulationSettings()
        options.timeIntegration.numberOfSteps = count
        options.timeIntegration.startTime, options.timeIntegration.endTime = float(t[0]), float(t[-1])
        options.timeIntegration.verboseMode = 0
        options.timeIntegration.newton.useModifiedNewton = False
        options.solutionSettings.writeSolutionToFile = False
        options.solutionSettings.sensorsWritePeriod = float(t[-1] - t[0]) / count if steps else spacing
        try:
            done = system.SolveDynamic(options, solverType=exudyn.DynamicSolverType.GeneralizedAlpha)
        except Exception as error:
            raise PeerError(f"Exudyn: {error}") from None
        q, v = (np.asarray(system.GetSensorStoredData(sensor)) for sensor in sensors)
        if not done or not np.isfinite(v).all() or (not steps and len(q) != len(t)):
            raise PeerError("Exudyn: the run did not reach its end")
        y = np.empty((2 * scene.n, len(q)))
        y[0::2], y[1::2] = q[:, 1:].T, v[:, 1:].T
        return Answer(t=q[:, 0], y=y, counters={"n_steps": count})


def _system(scene: SmoothScene) -> tuple[Any, tuple[Any, Any]]:
    """The system, and sensors of positions and velocities."""
    import exudyn
    from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2, SensorNode

    system = exudyn.SystemContainer().AddSystem()
    n = scene.n
    q, v = scene.split(scene.start[:, None])
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * n, initialCoordinates=q[:, 0].tolist(),
            initialCoordinates_t=v[:, 0].tolist(), numberOfODE2Coordinates=n,
        )
    )  # fmt: skip
    y = np.empty(2 * n)

    def force(system: Any, t: float, item: int, q: Any, v: Any) -> list[float]:
        y[0::2], y[1::2] = q, v
        accelerations: list[float] = scene.rhs(t, y)[1::2].tolist()
        return accelerations

    # accelerations as forces on unit masses
    system.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.eye(n), forceUserFunction=force))
    kinds = (exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t)
    first, second = (
        system.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind)) for kind in kinds
    )
    system.Assemble()
    return system, (first, second)


def exudyn_methods() -> list[Method]:
    """The adapter where the package is installed."""
    return [Exudyn()] if find_spec("exudyn") else []
