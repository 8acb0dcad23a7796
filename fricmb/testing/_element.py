"""Whether a force element keeps what scenes, plans and integrators rely on."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.scene import GROUND, Element, LinearForm, Part, Scene, parameter
from fricmb.testing._base import ConformanceError, Rule, findings, pickles
from fricmb.testing._element_forces import Trial, force_findings
from fricmb.testing._refusal import refuses


@answers
def check_element(
    element: Element,
    *,
    parts: Iterable[Part] = (),
    around: Sequence[float] | None = None,
    size: float = 1.0,
    largest: float = 1e6,
) -> None:
    """Try the rules that a run relies on.

    Parameters
    ----------
    element : Element
        With the values that it will be used with: an element may keep the rules for some values alone.
    parts : iterable of Part, optional
        Further parts whose motions it depends on, beside its ends.
    around : (n_x,), optional
        Local coordinates about which states are drawn; default 0.
    size : float
        Standard deviation of the coordinates and rates that are drawn, in the element's units.
    largest : float
        Greatest distance from ``around`` and greatest rate at which values must be finite.

    Raises
    ------
    ConformanceError
        Naming each broken rule with the numbers that show it.

    Notes
    -----
    It pickles; copies made again are equal; each parameter can be set, to a named parameter too; nan, infinity and,
    of those in ``positive``, 0 and -1 are refused by name.  Its local coordinates are linear forms in motions that
    exist.  The compiled force is ``-dV/dx - dR/dx' + F`` of what is stated, and its Jacobian the slope of that, both
    against differences in 80 digits; so are stored energy, loss and power.  The dissipation takes power, the Hessian
    of a potential is symmetric, all is finite at ``around``, near it and far away.  Cost: the compilation of its
    template, once.

    Examples
    --------
    >>> import fricmb as fm
    >>> block = fm.Body("block", mass=1.0)
    >>> fm.testing.check_element(fm.Spring("k", block, axis="x", stiffness=2.0))
    """
    if not isinstance(element, Element):
        raise ConformanceError(f"check_element takes an instance of a subclass of fm.Element, got {element!r}")
    rules: tuple[Rule, ...] = (_declared, pickles, _copies, refuses, _settable, _named)
    forms = list(_forms(element, tuple(parts)))
    found = [*forms] if forms else [*force_findings(element, _trial(element, around, size, largest))]
    findings(element._label(), (*rules, lambda _: iter(found)), element)


def _trial(element: Element, around: Sequence[float] | None, size: float, largest: float) -> Trial:
    n = len(element.local_coordinates())
    middle = (0.0,) * n if around is None else tuple(float(x) for x in around)
    if len(middle) != n:
        raise ConformanceError(f"{element._label()}: around must hold {n} number(s), got {len(middle)}")
    return Trial(middle, size, largest)


def _declared(element: Element) -> Iterator[str]:
    """Fields that a class states without being made a dataclass do not exist."""
    kind = type(element)
    fields = {field.name for field in dataclasses.fields(element)}
    for name, annotation in inspect.get_annotations(kind).items():
        if name not in fields and not name.startswith("_") and "ClassVar" not in str(annotation):
            yield f"{name} is no field: {kind.__name__} lacks @dataclass(frozen=True, kw_only=True)"


def _copies(element: Element) -> Iterator[str]:
    try:
        again = dataclasses.replace(element)
        if again != element or hash(again) != hash(element):
            yield "a copy made of the same fields is not equal to it"
    except Exception as error:
        yield f"cannot be made again of its own fields: {type(error).__name__}: {error}"


def _numbers(element: Element) -> dict[str, float]:
    return {path: value for path, value in element.numeric_slots().items() if isinstance(value, float | int)}


def _settable(element: Element) -> Iterator[str]:
    """Another value arrives, and the old one makes the old element."""
    for path, value in _numbers(element).items():
        other = float(value) * 1.125 if value else 0.125
        try:
            changed = element.with_slots({path: other})
            back = changed.with_slots({path: element.slots()[path]})
        except ValueError:
            continue  # its own validation: bounds that the other value breaks
        except Exception as error:
            yield f"{path} = {other:g} cannot be set: {type(error).__name__}: {error}"
            continue
        if changed.numeric_slots().get(path) != other or changed == element:
            yield f"{path} = {other:g} is set, but it holds {changed.numeric_slots().get(path)!r}"
        elif back != element:
            yield f"{path} set to {other:g} and back leaves another element"


def _named(element: Element) -> Iterator[str]:
    """A named parameter stays one: a scene lists it, a sweep changes it."""
    for path, value in _numbers(element).items():
        named = parameter("check_element", float(value))
        try:
            held: Any = element.with_slots({path: named}).slots().get(path)
        except Exception as error:
            yield f"{path} takes no named parameter: {type(error).__name__}: {error}"
            continue
        if held != named:
            yield f"{path} turns a named parameter into {held!r}"


def _forms(element: Element, parts: tuple[Part, ...]) -> Iterator[str]:
    """The local coordinates: linear forms in motions of a scene that holds the element and its ends."""
    try:
        forms = element.local_coordinates()
    except Exception as error:
        yield f"local_coordinates fails: {type(error).__name__}: {error}"
        return
    if not isinstance(forms, tuple) or not forms or not all(isinstance(form, LinearForm) for form in forms):
        yield f"local_coordinates must return a tuple of linear forms (such as body.motion('x')), got {forms!r}"
        return
    if forms != element.local_coordinates():
        yield "local_coordinates differ from one call to the next"
    if not any(form.terms for form in forms):
        yield "local_coordinates depend on nothing that moves"
    for form in forms:
        if not np.isfinite([form.constant, *(c for _, c in form.terms)]).all():
            yield f"the local coordinate {form} is not finite"
    owners = {part.name: part for part in parts}
    owners |= {end.owner.name: end.owner for end in element.ends() if end.owner is not GROUND}
    try:
        scene = Scene("check_element", [*owners.values(), element])
    except Exception as error:
        yield f"a scene of its ends and itself fails: {type(error).__name__}: {error}"
        return
    for name in dict.fromkeys(name for form in forms for name in form.motions if not scene.has_motion(name)):
        yield f"local_coordinates name the motion {name!r}, which does not exist; there are {scene.motion_names}"
