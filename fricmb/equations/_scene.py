"""The equations of motion of a whole scene in SymPy, from the same statements that the compiled templates come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy

from fricmb.equations._authors import element_math
from fricmb.equations._collector import Collector, exact
from fricmb.equations._friction import Friction, friction
from fricmb.equations._latex import typeset
from fricmb.equations._mechanism import Constraint, add_gravity, add_joint, add_rigid_body, add_space_body
from fricmb.equations._names import coordinate_symbols, subscript
from fricmb.equations._tree import in_joint_coordinates
from fricmb.errors import SceneError, shown
from fricmb.scene import (
    Body,
    Contact,
    Driven,
    Element,
    Force,
    Gravity,
    Joint,
    MatrixElement,
    ModalBody,
    RigidBody,
    SpaceBody,
)
from fricmb.scene._space_body import with_inner
from fricmb.values import is_expression, is_flag, value_of


@dataclass(frozen=True, kw_only=True)
class SceneEquations:
    """``M a = rhs`` with one symbol for each friction force.

    Attributes
    ----------
    q, v, a : Matrix, (n, 1)
        Coordinates, velocities, accelerations: ``x_pad``, ``xdot_pad``, ``xddot_pad``.
    M : Matrix, (n, n)
        Mass matrix.
    rhs : Matrix, (n, 1)
        Forces; friction appears as symbols (``F_lining_x``).
    contacts : tuple of Friction
        Of each contact the symbols of its force, its relative velocity, normal force and law.
    prescribed : dict of Symbol to expression
        Coordinates and velocities of driven bodies.
    values : dict of Symbol to float
        Numbers behind the symbols.
    t : Symbol
    constraints : tuple of Constraint
        Of each joint expressions that stay 0, and the symbols of their multipliers in ``rhs``.

    Notes
    -----
    Terms whose parameter is 0 are left out.
    """

    scene: str
    dof_names: tuple[str, ...]
    q: Any
    v: Any
    a: Any
    M: Any
    rhs: Any
    contacts: tuple[Friction, ...]
    prescribed: dict[Any, Any]
    values: dict[Any, float]
    t: Any
    constraints: tuple[Constraint, ...] = ()

    @property
    def equations(self) -> list[Any]:
        """One ``Eq`` for each degree of freedom."""
        return [sympy.Eq(left, right, evaluate=False) for left, right in zip(self.M * self.a, self.rhs, strict=True)]

    @property
    def friction_forces(self) -> dict[str, tuple[Any, ...]]:
        """Symbols of the friction force by contact."""
        return {contact.name: contact.force for contact in self.contacts}

    def slipping(self) -> Any:
        """``rhs`` with every friction force as its law gives it in slip (n, 1)."""
        replacement = {s: e for contact in self.contacts for s, e in zip(contact.force, contact.slip, strict=True)}
        return self.rhs.xreplace(replacement)

    def with_numbers(self) -> tuple[Any, Any]:
        """``M`` and ``rhs`` with the scene's numbers in place of its parameters."""
        values = {symbol: sympy.Float(value) for symbol, value in self.values.items()}
        prescribed = {symbol: sympy.sympify(e).xreplace(values) for symbol, e in self.prescribed.items()}
        return self.M.xreplace(values), self.rhs.xreplace(prescribed).xreplace(values)

    def latex(self) -> str:
        r"""The equations of motion, the friction laws and the prescribed motions as an ``align*`` environment."""
        rows = [f"{typeset(eq.lhs)} &= {typeset(eq.rhs)}" for eq in self.equations]
        rows += [row for constraint in self.constraints for row in constraint.latex_rows()]
        rows += [row for contact in self.contacts for row in contact.latex_rows()]
        rows += [f"{typeset(symbol)} &= {typeset(e)}" for symbol, e in self.prescribed.items()]
        return "\\begin{align*}\n" + " \\\\\n".join(rows) + "\n\\end{align*}"

    def _repr_latex_(self) -> str:
        return f"$$\n{self.latex()}\n$$"

    def __str__(self) -> str:
        rows = [f"equations of motion of {self.scene!r}"]
        rows += [f"  {eq.lhs} = {eq.rhs}" for eq in self.equations]
        rows += [f"  {row}" for constraint in self.constraints for row in constraint.text_rows()]
        rows += [f"  {row}" for contact in self.contacts for row in contact.text_rows()]
        rows += [f"  {symbol} = {sympy.sstr(e, full_prec=False)}" for symbol, e in self.prescribed.items()]
        return "\n".join(rows)


def scene_equations(scene: Any, *, joint_coordinates: bool = False) -> SceneEquations:
    """The equations of motion of a scene."""
    if not is_flag(joint_coordinates):
        raise SceneError(f"equations: joint_coordinates must be True or False, got {shown(joint_coordinates)}")
    plain: SceneEquations = scene._once("equations", lambda: _derive(scene))
    if not joint_coordinates:
        return plain
    found: SceneEquations = scene._once("equations in joints", lambda: in_joint_coordinates(scene, plain))
    return found


def _derive(scene: Any) -> SceneEquations:
    collector = Collector(scene=scene)
    n = len(scene.dof_names)
    symbols = [coordinate_symbols(name) for name in scene.dof_names]
    M, rhs = sympy.zeros(n, n), sympy.zeros(n, 1)
    index = {name: i for i, name in enumerate(scene.dof_names)}
    contacts = []
    constraints: list[Constraint] = []
    for part in with_inner(scene.parts):
        if isinstance(part, SpaceBody):
            add_space_body(collector, part, index, M)
        elif isinstance(part, RigidBody):
            add_rigid_body(collector, part, index, M)
        elif isinstance(part, Gravity):
            add_gravity(collector, part, index, rhs)
        elif isinstance(part, Joint):
            constraint, dry = add_joint(collector, part, rhs)
            constraints.append(constraint)
            contacts += [] if dry is None else [dry]
        elif isinstance(part, Body | ModalBody):
            _add_body(collector, part, index, M, rhs)
        elif isinstance(part, MatrixElement):
            _add_matrix(collector, part, index, M, rhs)
        elif isinstance(part, Element):
            _add_element(collector, part, rhs)
        elif isinstance(part, Contact):
            contacts.append(friction(collector, part))
            for force, row in contacts[-1].rows:
                _add(rhs, force, row)
        elif isinstance(part, Driven):
            _add_driven(collector, part)
    return SceneEquations(
        scene=scene.name,
        dof_names=scene.dof_names,
        q=sympy.Matrix([s[0] for s in symbols]),
        v=sympy.Matrix([s[1] for s in symbols]),
        a=sympy.Matrix([s[2] for s in symbols]),
        M=sympy.ImmutableMatrix(M),
        rhs=sympy.ImmutableMatrix(rhs),
        contacts=tuple(contacts),
        constraints=tuple(constraints),
        prescribed=collector.prescribed,
        values=collector.values,
        t=collector.t,
    )


def _add(rhs: Any, force: Any, row: Sequence[Any]) -> None:
    for i, coefficient in enumerate(row):
        if coefficient != 0:
            rhs[i] += coefficient * force


def _add_body(collector: Collector, body: Any, index: Mapping[str, int], M: Any, rhs: Any) -> None:
    if isinstance(body, Body):
        for name in body.dof_names:
            M[index[name], index[name]] += collector.number(body, "mass", body.mass)
        return
    for i, name in enumerate(body.dof_names):
        at, mode = index[name], str(i + 1)
        mass = sympy.S.One
        if body.masses is not None:
            mass = collector.number(body, f"masses.{mode}", body.masses[i])
        shared = not isinstance(body.damping_ratios, tuple)
        ratio = body.damping_ratios if shared else body.damping_ratios[i]
        zeta = collector.number(body, "damping_ratios" if shared else f"damping_ratios.{mode}", ratio)
        omega = collector.number(body, f"frequencies.{mode}", body.frequencies[i])
        position, velocity, _ = coordinate_symbols(name)
        M[at, at] += mass
        rhs[at] += -mass * omega**2 * position - 2 * mass * zeta * omega * velocity


def _add_matrix(collector: Collector, part: MatrixElement, index: Mapping[str, int], M: Any, rhs: Any) -> None:
    one = not is_expression(part.scale) and value_of(part.scale) == 1.0
    scale = sympy.S.One if one else collector.number(part, "scale", part.scale)
    for target in ("M", "C", "K"):
        value = getattr(part, target)
        if value is None or scale == 0:
            continue
        numbers = value_of(value)
        dense = numbers if isinstance(numbers, np.ndarray) else numbers.toarray()
        for i, j in zip(*(places.tolist() for places in np.nonzero(dense)), strict=True):
            symbol = subscript(target, part.name, str(i + 1), str(j + 1))
            collector.values[symbol] = float(dense[i, j])
            row, column = index[part.dofs[i]], index[part.dofs[j]]
            position, velocity, _ = coordinate_symbols(part.dofs[j])
            if target == "M":
                M[row, column] += scale * symbol
            else:
                rhs[row] -= scale * symbol * (position if target == "K" else velocity)


def _add_element(collector: Collector, element: Any, rhs: Any) -> None:
    forms = element.local_coordinates()
    if isinstance(element, Force):
        value = element.value
        free = is_expression(value)
        force = collector.expression(value) if free else collector.number(element, "value", value)
        _add(rhs, force, collector.row(forms[0]))
        return
    math = element_math(element, len(forms))
    replacement = collector.parameters(element, element)
    for form, x, v in zip(forms, math.x, math.v, strict=True):
        replacement[x], replacement[v] = collector.motion(form)
    replacement[math.t] = collector.t
    for form, force in zip(forms, math.total_force(), strict=True):
        # what is 0 goes first, so that whole terms vanish before anything is divided by it
        left = force.subs({s: e for s, e in replacement.items() if e == 0}).xreplace(replacement)
        _add(rhs, _tidy(left), collector.row(form))


def _tidy(force: Any) -> Any:
    """Without the guard that keeps norms differentiable at 0, and without 2 (x - L)/2."""
    guards = {number: sympy.S.Zero for number in force.atoms(sympy.Float) if 0 < abs(number) < 1e-150}
    terms = sympy.Add.make_args(force.xreplace(guards))
    return sympy.Add(*(sympy.factor_terms(term) for term in terms))


def _add_driven(collector: Collector, body: Driven) -> None:
    for letter in body.moving:
        position, velocity, _ = coordinate_symbols(f"{body.name}.{letter}")
        for symbol, field_name in ((position, "position"), (velocity, "velocity")):
            value = getattr(body, field_name).get(letter)
            if value is None:
                continue
            if field_name == "position" and letter in body.velocity:
                continue
            collector.prescribed[symbol] = (
                collector.expression(value) if is_expression(value) else sympy.sympify(exact(float(value_of(value))))
            )
        if letter not in body.velocity:
            collector.prescribed[velocity] = sympy.diff(collector.prescribed[position], collector.t)
