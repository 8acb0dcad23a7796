"""Rigid bodies, weight and joints in the equations of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy

from fricmb.equations._collector import Collector, exact
from fricmb.equations._friction import Friction, law_terms
from fricmb.equations._joint import joint_math
from fricmb.equations._latex import typeset
from fricmb.equations._names import coordinate_symbols, subscript
from fricmb.scene import Body, Gravity, Joint, RigidBody, SpaceBody
from fricmb.values import is_expression, value_of


@dataclass(frozen=True, kw_only=True)
class Constraint:
    """One joint: its name, expressions that stay 0, and the symbols of their multipliers.

    ``rigid``: its expression is a distance, at least 0, and its multiplier pushes only where that is 0.
    """

    name: str
    expressions: tuple[Any, ...]
    multipliers: tuple[Any, ...]
    rigid: bool = False

    def text_rows(self) -> list[str]:
        """Lines of text."""
        pairs = zip(self.expressions, self.multipliers, strict=True)
        if self.rigid:
            return [f"0 <= {expression}, 0 <= {multiplier}, one of them 0" for expression, multiplier in pairs]
        return [f"{expression} = 0  ({multiplier})" for expression, multiplier in pairs]

    def latex_rows(self) -> list[str]:
        """Rows of an ``align*`` environment."""
        if self.rigid:
            pairs = zip(map(typeset, self.expressions), map(typeset, self.multipliers), strict=True)
            return [rf"0 &\le {distance} \perp {push} \ge 0" for distance, push in pairs]
        return [f"{typeset(expression)} &= 0" for expression in self.expressions]


def add_rigid_body(collector: Collector, body: RigidBody, index: Mapping[str, int], M: Any) -> None:
    """Mass and inertia."""
    m = collector.number(body, "mass", body.mass)
    J = collector.number(body, "inertia", body.inertia)
    for name, value in zip(body.dof_names, (m, m, J), strict=True):
        M[index[name], index[name]] += value


def add_space_body(collector: Collector, body: SpaceBody, index: Mapping[str, int], M: Any) -> None:
    """Mass and moments of inertia of a body in space."""
    masses = body.masses(lambda path, value: collector.number(body, path, value))
    for name, value in zip(body.dof_names, masses, strict=True):
        M[index[name], index[name]] += value


def add_gravity(collector: Collector, gravity: Gravity, index: Mapping[str, int], rhs: Any) -> None:
    """Weight of all bodies."""
    for body in collector.scene.bodies:
        if not isinstance(body, Body | RigidBody | SpaceBody):
            continue
        for letter, value in gravity.acceleration.items():
            if f"{body.name}.{letter}" in index and float(value_of(value)) != 0.0:
                pull = collector.number(gravity, f"acceleration.{letter}", value)
                rhs[index[f"{body.name}.{letter}"]] += collector.number(body, "mass", body.mass) * pull


def add_joint(collector: Collector, joint: Joint, rhs: Any) -> tuple[Constraint, Friction | None]:
    """Reactions and friction of a joint."""
    forms, drives = joint.local_coordinates(), joint.drives()
    math = joint_math(joint, len(forms) + len(drives))
    replacement = collector.parameters(joint, joint.bare())
    count = len(math.lam)
    multipliers = tuple(
        subscript("lambda", joint.loaded_by or joint.name, *([str(i + 1)] if count > 1 else [])) for i in range(count)
    )
    replacement |= dict(zip(math.lam, multipliers, strict=True))
    for form, x, v in zip(forms, math.x, math.v, strict=False):
        replacement[x], replacement[v] = collector.motion(form)
    for drive, x, v in zip(drives, math.x[len(forms) :], math.v[len(forms) :], strict=True):
        replacement[x], replacement[v] = _prescribed(collector, joint, drive)
    expressions = tuple(_plain(phi.subs({s: e for s, e in replacement.items() if e == 0}).xreplace(replacement))
                        for phi in math.phi)  # fmt: skip
    for i, expression in enumerate(expressions):
        for place, dof in enumerate(collector.scene.dof_names):
            rhs[place] += multipliers[i] * sympy.diff(expression, coordinate_symbols(dof)[0])
    constraint = Constraint(
        name=joint.name, expressions=expressions, multipliers=multipliers[: len(math.phi)],
        rigid=joint.impact is not None,
    )  # fmt: skip
    if joint.friction is None or math.slip is None:
        return constraint, None
    return constraint, _friction(collector, joint, math, replacement, rhs)


def _prescribed(collector: Collector, joint: Joint, drive: tuple[str, Any, float]) -> tuple[Any, Any]:
    given, value, start = drive
    expression = collector.expression(value) if is_expression(value) else sympy.sympify(exact(float(value_of(value))))
    if given == "value":
        return expression + exact(start), sympy.diff(expression, collector.t)
    moved = subscript("s", joint.name)
    collector.prescribed[moved] = exact(start) + sympy.Integral(expression, (collector.t, 0, collector.t))
    return moved, expression


def _friction(collector: Collector, joint: Joint, math: Any, replacement: dict[Any, Any], rhs: Any) -> Friction:
    labels = joint.labels()
    forces, velocities, rows = [], [], []
    for label, held in zip(labels, math.slip, strict=True):
        force = subscript("F", joint.name, *([label] if len(labels) > 1 else []))
        factors = [_plain(s.xreplace(replacement)) for s in held]
        velocity = sum((s * replacement[v] for s, v in zip(factors, math.v, strict=True)), sympy.S.Zero)
        row = [sympy.diff(velocity, coordinate_symbols(dof)[1]) for dof in collector.scene.dof_names]
        for place, slope in enumerate(row):
            rhs[place] += slope * force
        forces.append(force)
        velocities.append(velocity)
        rows.append((force, row))
    normal = _plain(math.load.xreplace(replacement))
    terms = law_terms(collector, joint, ("friction", joint.friction), tuple(velocities), normal, list(labels))
    coefficient, break_away, slip, states = terms
    return Friction(
        name=joint.name,
        force=tuple(forces),
        velocity=tuple(velocities),
        normal_force=normal,
        coefficient=coefficient,
        break_away=break_away,
        slip=slip,
        states=states,
        rows=tuple(rows),
    )


def _plain(expression: Any) -> Any:
    """Without the guard that keeps norms differentiable at 0."""
    guards = {number: sympy.S.Zero for number in expression.atoms(sympy.Float) if 0 < abs(number) < 1e-150}
    return expression.xreplace(guards)
