"""What is left of an element for its numbers: what a plan needs to know about it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

from fricmb.equations._expressions import force_terms
from fricmb.equations._templates import Template, Terms, element_template
from fricmb.equations._values import numbers
from fricmb.scene import Force


@dataclass(frozen=True, kw_only=True)
class ElementFacts:
    """Which terms an element has for its present numbers.

    ``stiffness``, ``damping``, ``constant``: entries in the constant matrices and vectors; ``signal``: a function of
    time alone; ``nonlinear``: a compiled remainder; ``could_be_nonlinear``: its type has one for other numbers.
    """

    stiffness: bool
    damping: bool
    constant: bool
    signal: bool
    nonlinear: bool
    could_be_nonlinear: bool

    @property
    def empty(self) -> bool:
        """Whether nothing is left."""
        return not (self.stiffness or self.damping or self.constant or self.signal or self.nonlinear)


def element_facts(element: Any, driven: bool = False) -> ElementFacts:
    """Facts of an element; ``driven``: prescribed motions enter it."""
    if isinstance(element, Force):
        terms = force_terms(element.value, f"Force {element.name!r}: value")
        kinds = {kind for kind, _, _ in terms.slopes}
        return ElementFacts(
            stiffness="coordinate" in kinds,
            damping="speed" in kinds,
            constant=terms.constant != 0.0,
            signal=terms.signal is not None,
            nonlinear=terms.rest is not None,
            could_be_nonlinear=terms.rest is not None,
        )
    template = element_template(element, driven=driven)
    p = numbers(element)
    return facts_of(template.terms(p), template)


def facts_of(left: Terms, template: Template) -> ElementFacts:
    """Facts of what is left of a template for some numbers."""
    return _facts(bool(left.K), bool(left.C), bool(left.f), left.rest, template.facts["compiled"])


@cache
def _facts(stiffness: bool, damping: bool, constant: bool, nonlinear: bool, could_be_nonlinear: bool) -> ElementFacts:
    """One object for all elements of the same kind."""
    return ElementFacts(
        stiffness=stiffness,
        damping=damping,
        constant=constant,
        signal=False,
        nonlinear=nonlinear,
        could_be_nonlinear=could_be_nonlinear,
    )
