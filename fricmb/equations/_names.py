"""Symbols of a scene's equations: the user's names, readable as text and in LaTeX."""

from __future__ import annotations

import re
from typing import Any

import sympy

from fricmb.scene import Body, Contact, Damper, Force, ModalBody, PointDamper, PointSpring, RigidBody, SpaceBody, Spring
from fricmb.values import Parameter, is_expression

#: Letters for slots by type; other slots keep their name.
_LETTERS = {
    Body: {"mass": "m"},
    RigidBody: {"mass": "m", "inertia": "J"},
    SpaceBody: {"mass": "m", "inertia": "J", "inertia_across": "A", "inertia_axial": "C"},
    Spring: {"stiffness": "k", "cubic": "kappa", "length": "L"},
    PointSpring: {"stiffness": "k", "length": "L", "anchor": "a"},
    Damper: {"damping": "c"},
    PointDamper: {"damping": "c", "anchor": "a"},
    Force: {"value": "P"},
    ModalBody: {"frequencies": "omega", "damping_ratios": "zeta", "masses": "m"},
    Contact: {"normal_force": "N"},
}
_TURNING = {"turn_": "sigma", "axis_": "n", "d1_": "d1", "d2_": "d2", "d3_": "d3"}
_LAW_LETTERS = {"exponent": "n"}


def subscript(letter: str, *parts: str) -> Any:
    """A real symbol with subscripts: ``x_pad``, typeset with a subscript."""
    return sympy.Symbol("_".join((letter, *parts)), real=True)


def coordinate_symbols(dof: str) -> tuple[Any, Any, Any]:
    """Coordinate, velocity and acceleration of a motion: ``x_pad``, ``xdot_pad``, ``xddot_pad``."""
    owner, _, letter = dof.rpartition(".")
    parts = owner.split(".")
    if letter.startswith("mode"):
        parts, letter = [*parts, letter.removeprefix("mode")], "eta"
    if letter == "angle":
        letter = "theta"
    for name, symbol in _TURNING.items():  # of bodies in space: "top.axis_x" is n_top_x
        if letter.startswith(name):
            parts, letter = [*parts, letter.removeprefix(name)], symbol
    return tuple(subscript(letter + dots, *parts) for dots in ("", "dot", "ddot"))


def slot_symbol(part: Any, path: str, value: Any) -> Any:
    """Symbol of a number in a slot: ``k_1x`` for the stiffness of "k1x", ``k_coupling`` for that of "coupling"."""
    if isinstance(value, Parameter):
        return parameter_symbol(value.name)
    if is_expression(value):
        return value.xreplace({s: parameter_symbol(s.name) for s in value.free_symbols})
    head, _, rest = path.partition(".")
    letters = next((held for kind, held in _LETTERS.items() if isinstance(part, kind)), {})
    if head in ("law", "normal_force", "friction") and rest:
        name, _, index = rest.partition(".")
        return subscript(_LAW_LETTERS.get(name, name), *([index] if index else []), part.name)
    letter = letters.get(head, head)
    # "k1x", "k_ab", "cx", "kxy" are a letter and its index; "mass" is a word
    match = re.fullmatch(rf"{letter}(?:_(\w{{1,3}})|(\w|[xyz]{{2,3}}|(?=\w*\d)\w{{2,3}}))", part.name)
    if match and head == next(iter(letters), None):
        return subscript(letter, match[1] or match[2])
    return subscript(letter, *([rest] if rest else []), part.name)


def parameter_symbol(name: str) -> Any:
    """Symbol of a named parameter."""
    return sympy.Symbol(name, real=True)
