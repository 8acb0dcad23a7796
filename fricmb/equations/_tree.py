"""The equations of a scene in the joint coordinates of its trees; what is not a tree stays a constraint.

From the equations in coordinates of bodies, ``M a = f + G^T lambda``, and the tree's own ``q = X(s)`` with J = dX/ds
follows ``J^T M J s'' = J^T (f - M J' s')``: a tree's reactions do no work along s, and drop out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import sympy
from sympy.simplify.fu import TR8

from fricmb.equations._collector import Collector, exact
from fricmb.equations._names import coordinate_symbols
from fricmb.scene import Fixed, Prismatic, Revolute, RigidBody, topology
from fricmb.scene._rigid import start_angle

#: Joints with coordinates of their own, from which the pose of the body that hangs on follows.
HANGING = (Revolute, Prismatic, Fixed)


@dataclass
class Tree:
    """Coordinates of bodies as functions of those that are kept: ``pose``, and the names of the joints' own."""

    collector: Collector
    pose: dict[Any, Any] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)
    joints: set[str] = field(default_factory=set)

    def value(self, form: Any) -> Any:
        """A linear form in what is kept."""
        return self.collector.motion(form)[0].xreplace(self.pose)

    def hang(self, body: Any, joint: Any) -> bool:
        """Put a body on the tree; False where it keeps its own coordinates, as on a body that is driven."""
        outer = joint.a.owner is body
        other = (joint.b if outer else joint.a).owner
        if not isinstance(body, RigidBody):
            return False
        if not (isinstance(other, RigidBody) or not getattr(other, "letters", ())):
            return False
        near, far = (joint.a, joint.b) if outer else (joint.b, joint.a)
        angle = joint.angles()[1 if outer else 0]
        sign = 1 if outer else -1
        x, y, turn = (coordinate_symbols(name)[0] for name in body.dof_names)
        if isinstance(joint, Revolute):
            self.names.append(f"{joint.name}.angle")
            bend = coordinate_symbols(self.names[-1])[0]
        else:
            bend = exact(start_angle(joint.a) - start_angle(joint.b))
        turned = self.value(angle) + sign * bend
        shift = self._shift(joint, sign, turned if not outer else self.value(angle))
        for letter, symbol, s in zip("xy", (x, y), shift, strict=True):
            arm = (self.collector.motion(near.motion(letter))[0] - symbol).xreplace({turn: turned})
            self.pose[symbol] = self.value(far.motion(letter)) + s - arm
        self.pose[turn] = turned
        self.joints.add(joint.name)
        return True

    def _shift(self, joint: Any, sign: int, angle: Any) -> tuple[Any, Any]:
        """Of the two points of a guide, along its line in b."""
        if not isinstance(joint, Prismatic):
            return sympy.S.Zero, sympy.S.Zero
        self.names.append(f"{joint.name}.slide")
        slide = sign * coordinate_symbols(self.names[-1])[0]
        line = angle + self.collector.number(joint, "angle", joint.angle)
        return slide * sympy.cos(line), slide * sympy.sin(line)


def in_joint_coordinates(scene: Any, whole: Any) -> Any:
    """The equations ``whole`` of a scene in joint coordinates, wherever a pin, a guide or a weld hangs a body on."""
    tree = Tree(Collector(scene=scene, t=whole.t))
    for branch in topology(scene, [joint.name for joint in scene.joints if type(joint) in HANGING]).tree:
        if branch.joint is not None:
            tree.hang(scene[branch.body], scene[branch.joint])
    kept = (*tree.names, *(n for n in whole.dof_names if coordinate_symbols(n)[0] not in tree.pose))
    symbols = [coordinate_symbols(name) for name in kept]
    s, rate, second = (sympy.Matrix([x[i] for x in symbols]) for i in range(3))
    X = sympy.Matrix([tree.pose.get(q, q) for q in whole.q])
    J = X.jacobian(s)
    bias = sum((J.diff(c) * r for c, r in zip(s, rate, strict=True)), sympy.zeros(*J.shape)) * rate
    moves: dict[Any, Any] = {v: e for v, e in zip(whole.v, J * rate, strict=True) if v not in set(rate)}
    into = {**tree.pose, **moves}
    gone = {m: sympy.S.Zero for c in whole.constraints if c.name in tree.joints for m in c.multipliers}
    forces = whole.rhs.xreplace(gone).xreplace(into)
    return replace(
        whole,
        dof_names=kept, q=s, v=rate, a=second,
        M=sympy.ImmutableMatrix((J.T * whole.M * J).applyfunc(_tidy)),
        rhs=sympy.ImmutableMatrix((J.T * (forces - whole.M * bias)).applyfunc(_tidy)),
        contacts=tuple(_contact_in_coordinates(contact, into, J) for contact in whole.contacts),
        constraints=tuple(
            replace(c, expressions=tuple(_tidy(e.xreplace(tree.pose)) for e in c.expressions))
            for c in whole.constraints if c.name not in tree.joints
        ),
        values={**whole.values, **tree.collector.values},
    )  # fmt: skip


def _contact_in_coordinates(contact: Any, into: Mapping[Any, Any], J: Any) -> Any:
    """A contact or the friction of a joint in other coordinates."""

    def put(expression: Any) -> Any:
        return None if expression is None else sympy.sympify(expression).xreplace(into)

    rows = []
    for force, row in contact.rows:
        moved = sympy.Matrix([row]).xreplace(into) * J
        rows.append((put(force), [_tidy(e) for e in moved]))
    return replace(
        contact,
        velocity=tuple(_tidy(put(e)) for e in contact.velocity), normal_force=put(contact.normal_force),
        coefficient=put(contact.coefficient), break_away=put(contact.break_away),
        slip=tuple(put(e) for e in contact.slip), states={z: put(e) for z, e in contact.states.items()},
        rows=tuple(rows),
    )  # fmt: skip


def _tidy(expression: Any) -> Any:
    """Products of sines and cosines as sums: what cancels does so, and squares of both add up to 1."""
    terms = sympy.Add.make_args(sympy.expand(expression))
    return sympy.expand(sympy.Add(*(TR8(term) if term.has(sympy.sin, sympy.cos) else term for term in terms)))
