"""What a run found, for a person and for a program."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.errors import IntegrationError, Interrupted
from fricmb.integrate import STICK
from fricmb.integrate.event_kinds import OF_CONTACTS


def as_text(sol: fm.Solution) -> str:
    """The solution's own summary, under the name of the scene, and what the plan left out."""
    left_out = sol.scene.plan().left_out
    lines = [sol.scene.name, sol.summary()]
    lines += [f"left out     {item}" for item in left_out] or ["left out     nothing"]
    return "\n".join(lines)


def as_json(sol: fm.Solution, failure: IntegrationError | Interrupted | None = None) -> dict[str, Any]:
    """Everything the text says, as data; ``failure`` has the time and the reason where a run stopped early."""
    energy = sol.energy
    return {
        "scene": sol.scene.name,
        "t_start": sol.t_start,
        "t_end": sol.t_end,
        "units": asdict(sol.units),
        "failure": None if failure is None else {"t": failure.t, "reason": failure.reason},
        "contacts": {
            name: {
                "events": {
                    kind: sum(e.kind == kind and e.contact == name for e in sol.events)
                    for kind in OF_CONTACTS
                },
                "stick_share": sol.time_share(name, STICK),
                "rest_share": sol.rest_share(name),
                "friction_loss": float(energy.friction_loss_by_contact[k, -1]),
            }
            for k, name in enumerate(sol.contact_names)
        },
        "energy": {
            "start": float(energy.kinetic[0] + energy.potential[0]),
            "end": float(energy.kinetic[-1] + energy.potential[-1]),
            "friction_loss": float(energy.friction_loss[-1]),
            "damping_loss": float(energy.damping_loss[-1]),
            "input": float(energy.input[-1]),
            "residual": float(np.abs(energy.residual).max()),
        },
        "left_out": [str(item) for item in sol.scene.plan().left_out],
        "final": {
            "position": dict(zip(sol.dof_names, sol.q[:, -1].tolist(), strict=True)),
            "velocity": dict(zip(sol.dof_names, sol.v[:, -1].tolist(), strict=True)),
        },
        "stats": asdict(sol.stats),
    }
