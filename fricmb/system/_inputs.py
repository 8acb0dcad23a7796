"""Functions of time that act in a scene, as integrators ask about them before a run."""

from __future__ import annotations

from collections.abc import Sequence

from fricmb.equations import Template, formula
from fricmb.integrate.problem import Input
from fricmb.integrate.signals.pieces import table_at


def inputs_of(timed: Sequence[tuple[Template, tuple[float, ...]]]) -> tuple[Input, ...]:
    """Every function of time in templates with their parameters, each once."""
    found: dict[Input, None] = {}
    for template, parameters in timed:
        tables = tuple(table_at(parameters[fact["table"]]) for fact in template.facts.get("series", ()))
        for fact in template.facts.get("inputs", ()):
            tape = fact.get("tape")
            function = formula(fact["source"]) if tape is None else None
            entries = None if tape is None else tuple(map(tuple, tape))
            given = Input(
                tape=entries, parameters=tuple(parameters), function=function, rates=fact["rates"], tables=tables
            )
            found[given] = None
    return tuple(found)


def forces_of(timed: Sequence[tuple[Template, tuple[float, ...]]]) -> tuple[Input | None, ...]:
    """Of each signal that is a force the whole function, where it has bounds."""
    found: list[Input | None] = []
    for template, parameters in timed:
        tape = template.facts.get("whole")
        entries = None if tape is None else tuple(map(tuple, tape))
        tables = tuple(table_at(parameters[fact["table"]]) for fact in template.facts.get("series", ()))
        given = Input(tape=entries, parameters=tuple(parameters), tables=tables)
        found.append(None if tape is None else given)
    return tuple(found)
