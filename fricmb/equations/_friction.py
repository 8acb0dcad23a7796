"""A contact in the equations of a scene: its force, relative velocity, normal force and law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy

from fricmb.equations._latex import typeset
from fricmb.equations._names import subscript
from fricmb.equations._normal import normal_expression
from fricmb.laws._numeric import coefficient_expression, force_expression
from fricmb.values import is_expression, symbolic


@dataclass(frozen=True, kw_only=True)
class Friction:
    """One contact.

    Attributes
    ----------
    name : str
    force : tuple of Symbol
        Friction force on the contact's a, one for each tangential direction.
    velocity : tuple of expression
        Velocity of a relative to b.
    normal_force : expression
    coefficient, break_away : expression or None
        In slip at speed r = |velocity|, and while sticking; None for a force law.
    slip : tuple of expression
        Force in slip (of a force law: always).
    states : dict of Symbol to expression
        Rates of internal states.
    rows : tuple of (expression, list)
        Forces and their coefficients on the degrees of freedom.
    """

    name: str
    force: tuple[Any, ...]
    velocity: tuple[Any, ...]
    normal_force: Any
    coefficient: Any | None
    break_away: Any | None
    slip: tuple[Any, ...]
    states: dict[Any, Any]
    rows: tuple[tuple[Any, list[Any]], ...]

    @property
    def speed(self) -> Any:
        """|velocity|."""
        return _norm(self.velocity)

    def text_rows(self) -> list[str]:
        """Lines of text."""
        law = "" if self.coefficient is None else "  (slip)"
        rows = [f"{s} = {e}{law}" for s, e in zip(self.force, self.slip, strict=True)]
        if self.break_away is not None:
            stick = ", ".join(f"{g} = 0" for g in self.velocity)
            rows.append(f"{stick},  |F_{self.name}| <= {self.break_away * self.normal_force}  (stick)")
        return rows + [f"d/dt {s} = {e}" for s, e in self.states.items()]

    def latex_rows(self) -> list[str]:
        """Rows of an ``align*`` environment."""
        law = "" if self.coefficient is None else r" \quad \text{(slip)}"
        rows = [f"{typeset(s)} &= {typeset(e)}{law}" for s, e in zip(self.force, self.slip, strict=True)]
        if self.break_away is not None:
            length, cone = typeset(_norm(self.force)), typeset(self.break_away * self.normal_force)
            rows += [f"{typeset(g)} &= 0" + r" \quad \text{(stick)}" for g in self.velocity]
            rows.append(f"{length} &\\leq {cone}" + r" \quad \text{(stick)}")
        return rows + [f"\\frac{{d}}{{d t}} {typeset(s)} &= {typeset(e)}" for s, e in self.states.items()]


def _norm(components: Any) -> Any:
    if len(components) == 1:
        return sympy.Abs(components[0])
    return sympy.sqrt(sum(c**2 for c in components))


def friction(collector: Any, contact: Any) -> Friction:
    """A contact with the symbols of its scene."""
    directions = contact.directions()
    force = tuple(subscript("F", contact.name, direction.label) for direction in directions)
    velocity = []
    for direction, slide in zip(directions, contact.slides(), strict=True):
        _, rate = collector.motion(direction.form)
        velocity.append(rate + (collector.expression(slide) if is_expression(slide) else sympy.sympify(slide)))
    rows = [(s, collector.row(direction.form)) for s, direction in zip(force, directions, strict=True)]
    normal, pushes = _normal_force(collector, contact)
    letters = [direction.label for direction in directions]
    found = law_terms(collector, contact, ("law", contact.law), tuple(velocity), normal, letters)
    coefficient, break_away, slip, states = found
    return Friction(
        name=contact.name,
        force=force,
        velocity=tuple(velocity),
        normal_force=normal,
        coefficient=coefficient,
        break_away=break_away,
        slip=slip,
        states=states,
        rows=(*rows, *pushes),
    )


def _normal_force(collector: Any, contact: Any) -> tuple[Any, list[tuple[Any, list[Any]]]]:
    if contact.normal_kind == "constant":
        return collector.number(contact, "normal_force", contact.normal_force), []
    if contact.normal_kind == "expression":
        return sympy.Max(0, collector.expression(contact.normal_force)), []
    law, direction = contact.normal_force, contact.normal_direction()
    e, rate, N, _ = normal_expression(law)
    replacement = collector.parameters(contact, law, "normal_force.")
    replacement[e], replacement[rate] = collector.motion(direction.form)
    pressed = sympy.Max(0, N.xreplace(replacement))
    preload = collector.number(contact, "normal_force.preload", law.preload)
    return pressed, [(pressed - preload, collector.row(direction.form))]


def law_terms(
    collector: Any, contact: Any, held_law: tuple[str, Any], velocity: tuple[Any, ...], normal: Any, letters: list[str]
) -> tuple[Any, Any, Any, dict[Any, Any]]:
    """Coefficient, break-away coefficient, force in slip and rates of states of a law, held in the named field."""
    field, law = held_law
    if law.compiled_coefficient() is not None:
        mu = sympy.Function(f"mu_{contact.name}")(_norm(velocity))
        limit = sympy.Function(f"mu_{contact.name}")(0)
        return mu, limit, _opposing(mu, normal, velocity), {}
    if law.kind == "smooth" and law.compiled_force(len(velocity)) is not None:
        names = [subscript(*_named(law, label, contact.name, letters)) for label in law.state_labels(letters)]
        given = (*velocity, normal, *names)
        force = tuple(sympy.Function(f"F_{contact.name}_{label}")(*given) for label in letters)
        return None, None, force, {name: sympy.Function(f"rate_{name}")(*given) for name in names}
    stand = symbolic(law)
    replacement = collector.parameters(contact, law, f"{field}.")
    if law.kind == "smooth":
        d = len(velocity)
        v, N, z, force, rate = force_expression(law, stand, d)
        names = [subscript(*_named(law, label, contact.name, letters)) for label in law.state_labels(letters)]
        replacement |= dict(zip((*v, *z), (*velocity, *names), strict=True)) | {N: normal}
        states = {name: e.xreplace(replacement) for name, e in zip(names, rate, strict=True)}
        return None, None, tuple(e.xreplace(replacement) for e in force), states
    r, N, mu = coefficient_expression(law, stand)
    path = law.static_path
    if path is None:
        break_away = _at_rest(mu, r).xreplace(replacement | {N: normal})
    else:
        break_away = collector.number(contact, f"{field}.{path}", law.slots()[path])
    scale = [sympy.sympify(s).xreplace(replacement) for s in stand.standin.axis_scale() or (1,) * len(velocity)]
    scaled = tuple(s * g for s, g in zip(scale, velocity, strict=True))
    mu = mu.xreplace(replacement | {r: _norm(scaled), N: normal})
    return mu, break_away, tuple(s * f for s, f in zip(scale, _opposing(mu, normal, scaled), strict=True)), {}


def _named(law: Any, label: str, contact: str, directions: list[str]) -> tuple[str, ...]:
    """A state's letter, its contact, its direction."""
    letter, _, direction = label.partition(".")
    if letter in law.scalars:
        return (letter, contact)
    return (letter, contact, direction or directions[0])


def _at_rest(mu: Any, r: Any) -> Any:
    """The coefficient for r -> 0: its value there, or the limit where it has none (written, where SymPy finds none)."""
    value = mu.subs(r, 0)
    if not value.has(sympy.nan, sympy.oo, -sympy.oo, sympy.zoo):
        return value
    try:
        return sympy.limit(mu, r, 0, "+")
    except (NotImplementedError, RecursionError):
        return sympy.Limit(mu, r, 0, "+")


def _opposing(mu: Any, normal: Any, velocity: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(-mu * normal * g / _norm(velocity) for g in velocity)
