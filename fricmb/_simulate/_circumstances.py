"""What goes on where no step could be taken any more, and what to try: for the message of the error."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from fricmb.integrate import Trajectory
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.trajectory import MotionSamples
from fricmb.scene import Contact
from fricmb.values import is_expression

if TYPE_CHECKING:
    from fricmb._simulate._mechanics import SceneMechanics

#: How such reasons begin.
NO_STEP = ("the step size fell", "transitions pile up")
#: A slip slower than this part of its fastest is near rest; a contact that holds this part of its limit is at it.
SLOW, FULL = 1e-5, 0.999
#: Names in a message.
MOST = 4


def circumstances(mechanics: SceneMechanics, trajectory: Trajectory, reason: str) -> str:
    """Which contacts are about to change, what moves most, what to try, as the end of a sentence."""
    if not reason.startswith(NO_STEP):
        return ""
    seen = trajectory.row_motion()
    if not (np.isfinite(seen.q).all() and np.isfinite(seen.v).all()):
        return ""
    slow, full = _about_to_change(mechanics, seen)
    found = (("near rest:", slow), ("at the limit of sticking:", full))
    said = [f"{what} {_listed(names)}" for what, names in found if names]
    if (dof := _hardest(mechanics, seen)) is not None:
        said.append(f"{dof} is pushed hardest there")
    return "".join(f"; {part}" for part in said) + f"; try {_advice(mechanics, slow + full)}"


def _about_to_change(mechanics: SceneMechanics, seen: MotionSamples) -> tuple[list[str], list[str]]:
    """Contacts that slip next to nothing, and those that stick and hold all they can, in the last row."""
    parts = {part.name: part for part in mechanics.scene.parts}
    slow, full = [], []
    for k, (name, (a, b)) in enumerate(zip(mechanics.names.contacts, pairwise(mechanics.names.row), strict=True)):
        speed = np.sqrt((seen.g[a:b] ** 2).sum(axis=0))
        mode, N = int(seen.mode[k, -1]), float(seen.N[k, -1])
        law = getattr(parts.get(name), "law", None)
        if mode == SLIP and speed[-1] <= SLOW * speed.max():
            slow.append(name)
        elif mode == STICK and law is not None and law.kind != "smooth":
            held = float(np.sqrt((seen.F[a:b, -1] ** 2).sum()))
            try:
                limit = float(law.break_away(N)) * N
            except Exception:  # a law of the user's own may raise what it likes; this is but a message
                continue
            if held >= FULL * limit:
                full.append(name)
    return slow, full


def _hardest(mechanics: SceneMechanics, seen: MotionSamples) -> str | None:
    """The degree of freedom whose velocity changes most between the last rows, beside its largest."""
    if seen.t.size < 2 or not len(mechanics.names.dofs):
        return None
    top = np.abs(seen.v).max(axis=1)
    change = np.divide(np.abs(seen.v[:, -1] - seen.v[:, -2]), top, out=np.zeros_like(top), where=top > 0.0)
    return str(mechanics.names.dofs[int(np.argmax(change))]) if change.any() else None


def _advice(mechanics: SceneMechanics, changing: list[str]) -> str:
    parts = {part.name: part for part in mechanics.scene.parts}
    if len(changing) > 1:
        return (
            "to set these contacts apart by a little (their coefficients by 1e-6, say): they change at one instant, and"
            " more than one order may be possible"
        )
    import sympy

    jumping = sympy.Piecewise, sympy.sign, sympy.Heaviside
    jumps = [
        part.name
        for part in mechanics.scene.parts
        if any(is_expression(value) and value.has(*jumping) for value in part.slots().values())
    ]
    laws = [(name, getattr(parts.get(name), "law", None)) for name in mechanics.names.contacts]
    steep = [name for name, law in laws if law is not None and law.kind == "smooth"]
    if steep:
        return f"a softer law for {_listed(steep)} (a larger v_reg or v_rest), or a looser rtol"
    if jumps:
        return f"to smooth what jumps with the motion in {_listed(jumps)}"
    one = f" of {changing[0]!r}" if changing and isinstance(parts.get(changing[0]), Contact) else ""
    return f"to move the start or a coefficient{one} by a little, which shows whether it is one point; or a looser rtol"


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - MOST} more" if len(names) > MOST else ""
    return ", ".join(repr(name) for name in names[:MOST]) + more
