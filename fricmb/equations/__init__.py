"""Equations: every type of element and law states its physics once, in SymPy; forces and Jacobians are derived.

What is derived is kept on disk as compiled templates, found again without SymPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmb.equations._expressions import (
    Expression,
    ForceTerms,
    Signal,
    bend_expression,
    force_expression,
    force_terms,
    signal_expression,
    uniform_signal,
    value_expression,
)
from fricmb.equations._facts import ElementFacts, element_facts
from fricmb.equations._groups import Group, element_groups
from fricmb.equations._store import folder, function
from fricmb.equations._templates import (
    SwitchFormulas,
    Template,
    bend_template,
    derivations,
    element_template,
    formula,
    joint_template,
    law_template,
    normal_bend_template,
    normal_template,
    place_template,
)
from fricmb.equations._values import numbers
from fricmb.scene import Scene

if TYPE_CHECKING:
    from fricmb.equations._scene import SceneEquations


def scene_equations(scene: Scene, *, joint_coordinates: bool = False) -> SceneEquations:
    """The equations of motion of a whole scene in SymPy, on demand."""
    from fricmb.equations._scene import scene_equations as derive

    return derive(scene, joint_coordinates=joint_coordinates)


__all__ = [
    "ElementFacts",
    "Expression",
    "ForceTerms",
    "Group",
    "Signal",
    "SwitchFormulas",
    "Template",
    "bend_expression",
    "bend_template",
    "derivations",
    "element_facts",
    "element_groups",
    "element_template",
    "folder",
    "force_expression",
    "force_terms",
    "formula",
    "function",
    "joint_template",
    "law_template",
    "normal_bend_template",
    "normal_template",
    "numbers",
    "place_template",
    "scene_equations",
    "signal_expression",
    "uniform_signal",
    "value_expression",
]
