"""Methods that users expect on a low layer and that a higher one does: ``scene.plan()``, ``sol.plot``, ``law.creep()``.

A module imports from its own layer or a lower one.  What reaches up is named here, all of it, and nowhere else: the
target is imported when the method is first called.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from importlib import import_module
from operator import attrgetter
from typing import Any, ParamSpec, TypeVar

from fricmb._calls import answers

_P = ParamSpec("_P")
_R = TypeVar("_R")

#: What does the work of each method, "module:name" both; it is called with the same arguments.
TARGETS = {
    "fricmb._fit._result:Fit.plot": "fricmb.plot._fits:FitPlots",
    "fricmb._sweep._results:SweepResults.plot": "fricmb.plot._sweep:draw_results",
    "fricmb.analysis._poincare:BifurcationDiagram.plot": "fricmb.plot._branches:DiagramPlots",
    "fricmb.analysis._response:FrequencyResponse.plot": "fricmb.plot._response:ResponsePlots",
    "fricmb.analysis.cycles._branch:Branch.plot": "fricmb.plot._branches:BranchPlots",
    "fricmb.laws._base:FrictionLaw._repr_html_": "fricmb.plot._html:law_html",
    "fricmb.laws._regimes:Regimes.creep": "fricmb.analysis._creep:creep",
    "fricmb.measure._compare:Comparison.plot": "fricmb.plot._comparison:ComparisonPlots",
    "fricmb.plan._plan:Plan._repr_html_": "fricmb.plot._html:plan_html",
    "fricmb.scene._scene:Scene._repr_html_": "fricmb.plot._html:scene_html",
    "fricmb.scene._scene:Scene.draw": "fricmb.plot._animation:draw_scene",
    "fricmb.scene._scene:Scene.equations": "fricmb.equations:scene_equations",
    "fricmb.scene._scene:Scene.modes": "fricmb.analysis._natural:natural_modes",
    "fricmb.scene._scene:Scene.plan": "fricmb.plan:make_plan",
    "fricmb.solution._differentiated:Differentiated._differentiate": "fricmb.sensitivity:derive",
    "fricmb.solution._signals:Signals._element_axes": "fricmb.field:element_axes",
    "fricmb.solution._signals:Signals._from_scene": "fricmb.field:from_scene",
    "fricmb.solution._solution:Solution._repr_html_": "fricmb.plot._view:solution_notebook",
    "fricmb.solution._solution:Solution.audit": "fricmb.audit:audit",
    "fricmb.solution._solution:Solution.plot": "fricmb.plot:SolutionPlots",
    "fricmb.solution._solution:Solution.touches": "fricmb.field:touches",
}
#: Objects of higher layers that files have a word for.
WORDS = {
    "ground": "fricmb.scene:GROUND",
    "scene": "fricmb._simulate._mechanics:mechanics_of",
}


@cache
def find(target: str) -> Any:
    """The object that "module:name" stands for; its module is imported."""
    module, _, path = target.partition(":")
    return attrgetter(path)(import_module(module))


def facade(method: Callable[_P, _R]) -> Callable[_P, _R]:
    """Let a higher layer do what a method declares.

    The method has a signature and a docstring, which users, type checkers and completion see, and no body; what does
    its work is the entry of :data:`TARGETS` by its name.
    """
    target, checked = TARGETS[f"{method.__module__}:{method.__qualname__}"], answers(method)

    @wraps(method)
    def reach_up(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        checked(*args, **kwargs)  # does nothing, but refuses arguments that it does not have by its own name
        result: _R = find(target)(*args, **kwargs)
        return result

    return reach_up
