"""Templates of element and law types: derived once, kept on disk, found again without SymPy."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Any

from fricmb.equations import _store
from fricmb.equations._values import fingerprint, source_fingerprint, structure
from fricmb.integrate.signals.jets import Entry
from fricmb.integrate.signals.pieces import series_value

_NAMES = {name: getattr(math, name) for name in dir(math) if not name.startswith("_")} | {"series": series_value}

#: Derivations made in this process (for tests and ``fricmb plan``): kind of template and key.
derivations: list[str] = []


def formula(text: str, arguments: str = "p") -> Callable[..., Any]:
    """A Python function of generated source."""
    return eval(f"lambda {arguments}: {text}", dict(_NAMES))  # type: ignore[no-any-return]  # own generated source


@cache
def _compiled(function: Callable[..., None]) -> Any:
    """The kernel of a law that brings its own, kept for good: its code is freed with the object."""
    from fricmb.integrate.compile.template import template

    return template(function)


Entries = tuple[tuple[int, int, float], ...]
#: Where an expression switches: the place, or None where it has to be searched; what changes its sign; its bounds.
SwitchFormulas = tuple[Callable[..., float] | None, Callable[..., float], tuple[Entry, ...] | None]


@dataclass(frozen=True, kw_only=True)
class Terms:
    """Entries of an element for its numbers: stiffness, force, damping; V at x = 0; whether anything else remains."""

    K: Entries
    f: Entries
    C: Entries
    constant: float
    rest: bool


@dataclass(frozen=True)
class Template:
    """A derived template: its key, the facts stored beside it, and its kernel.

    ``source``: kernels of laws that bring their own compiled function have no key on disk but this function.
    """

    key: str
    facts: dict[str, Any]
    function: Callable[..., None] | None = None

    @cached_property
    def address(self) -> int:
        """Address of the compiled kernel, 0 if there is none; compiled or loaded on first use."""
        if self.function is not None:
            return int(_compiled(self.function).address)
        return _store.address(self.key) if self.facts["compiled"] else 0

    @cached_property
    def matrices(self) -> Callable[[Sequence[float]], dict[str, Any]]:
        """Entries of the affine part of an element for given parameters."""
        names = ("K", "f", "C", "work_K", "work_C", "work_f")
        rows = ", ".join(f"({i}, {j}, {text})" for name in names for i, j, text in self.facts[name])
        evaluate = formula(f"[{rows}]")
        slices: dict[str, slice] = {}
        at = 0
        for name in names:
            slices[name] = slice(at, at + len(self.facts[name]))
            at += len(self.facts[name])

        def entries(p: Sequence[float]) -> dict[str, Any]:
            values = evaluate(p)
            return {name: [entry for entry in values[part] if entry[2] != 0.0] for name, part in slices.items()}

        return entries

    @cached_property
    def terms(self) -> Callable[[tuple[float, ...]], Terms]:
        """The affine part for given parameters, once for elements that share them."""

        @lru_cache(maxsize=256)
        def terms(p: tuple[float, ...]) -> Terms:
            e = self.matrices(p)
            return Terms(
                K=(*e["K"], *e["work_K"]),
                f=(*e["f"], *e["work_f"]),
                C=(*e["C"], *e["work_C"]),
                constant=float(self.constant(p)),
                rest=self.rest(p),
            )

        return terms

    @cached_property
    def constant(self) -> Callable[[Sequence[float]], float]:
        """Potential at x = 0 of the affine part."""
        return formula(self.facts["constant"])

    @cached_property
    def rest(self) -> Callable[[Sequence[float]], bool]:
        """Whether anything nonlinear remains for given parameters."""
        factors = self.facts.get("rest", [])
        evaluate = formula("[" + ", ".join(factors) + "]")
        return lambda p: any(value != 0.0 for value in evaluate(p))

    @cached_property
    def at_rest(self) -> Callable[[Sequence[float]], float] | None:
        """Limit of a coefficient for r -> 0: of the parameters followed by the normal force."""
        text = self.facts.get("mu_0")
        return None if text is None else formula(text)

    @cached_property
    def is_constant(self) -> Callable[[Sequence[float]], bool]:
        """Whether a coefficient depends neither on speed nor on load for given parameters."""
        if self.facts["kind"] == "constant":
            return lambda p: True
        if self.facts["kind"] != "coefficient":
            return lambda p: False
        every = formula("[" + ", ".join(self.facts["all_zero"]) + "]")
        single = formula("[" + ", ".join(self.facts["any_zero"]) + "]")
        return lambda p: all(v == 0.0 for v in every(p)) or any(v == 0.0 for v in single(p))

    @cached_property
    def instants(self) -> list[SwitchFormulas]:
        """Of a signal: instants of its switches (None where they have to be searched), what switches, its bounds.

        Of a coefficient: the same, of slip speed in place of time.
        """
        return self._switches("switches")

    @cached_property
    def instants_by_load(self) -> list[SwitchFormulas]:
        """Of a coefficient: as :attr:`instants`, of those that depend on the normal force, behind the parameters."""
        return self._switches("switches_by_load")

    def _switches(self, name: str) -> list[SwitchFormulas]:
        return [
            (
                None if s["instant"] is None else formula(s["instant"]),
                formula(s["function"]),
                None if s.get("tape") is None else tuple(map(tuple, s["tape"])),
            )
            for s in self.facts.get(name, [])
        ]


_found: dict[tuple[Any, ...], Template] = {}


def get(kind: str, content: Sequence[object], derive: Callable[[], tuple[dict[str, Any], str | None]]) -> Template:
    """A template from memory of the disk, or derived and stored."""
    key = _store.key(kind, *content)
    facts = _store.read(key)
    if facts is None:
        derivations.append(key)
        facts, source = derive()
        _store.write(key, facts, source)
    return Template(key, facts)


def _content(declaration: Any, shape: tuple[Any, ...], text: Callable[[], str]) -> list[object]:
    """What identifies a derivation: the source of our own types, the derived expressions of anybody else's."""
    kind: type = type(declaration)
    source = fingerprint(declaration)
    own = (kind.__module__, kind.__qualname__)
    return [*own, *shape[1:], source if source is not None else text()]


def element_template(element: Any, *, driven: bool) -> Template:
    """Template of an element's type; ``driven``: prescribed motions enter its local coordinates."""
    shape = structure(element)
    n = len(element.local_coordinates())
    found = _found.get((shape, n, driven))
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._authors import element_math
            from fricmb.equations._element import derive as derive_element

            return derive_element(element_math(element, n), type(element).__name__, driven=driven)

        content = _content(element, shape, lambda: _element_text(element, n))
        found = _found[shape, n, driven] = get("element", [*content, n, driven], derive)
    return found


def bend_template(element: Any) -> Template | None:
    """Template of the functions at whose sign changes an element bends; None without any.

    Of the elements of this package few bend, and these say so.

    Facts: ``count`` of them, and their ``arguments`` as those of :func:`element_template`.
    """
    if type(element).__module__.startswith("fricmb.") and not element.bends:
        return None
    shape = structure(element)
    n = len(element.local_coordinates())
    key = ("bends", shape, n)
    found = _found.get(key)
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._authors import element_math
            from fricmb.equations._element import derive_bends

            return derive_bends(element_math(element, n), type(element).__name__)

        content = _content(element, shape, lambda: _element_text(element, n))
        found = _found[key] = get("element_bends", [*content, n], derive)
    return found if found.facts["count"] else None


def law_template(law: Any, d: int) -> Template:
    """Template of a friction law in ``d`` tangential directions (a coefficient serves any number)."""
    smooth = law.kind == "smooth"
    own = law.compiled_force(d) if smooth else law.compiled_coefficient()
    if own is not None:
        key = ("compiled", own)
        if key not in _found:
            facts = {"kind": "smooth" if smooth else "coefficient", "all_zero": ["1"], "any_zero": [], "mu_0": None}
            _found[key] = Template(own.__qualname__, facts | {"compiled": True}, own)
        return _found[key]
    shape = structure(law)
    rows = d if smooth else 0
    found = _found.get((shape, rows))
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._authors import derive_law

            return derive_law(law, rows)

        content = _content(law, shape, lambda: _law_text(law, rows))
        found = _found[shape, rows] = get("law", [*content, rows], derive)
    return found


def _element_text(element: Any, n: int) -> str:
    from fricmb.equations._authors import element_math

    return element_math(element, n).text()


def _law_text(law: Any, rows: int) -> str:
    from fricmb.equations._authors import law_text

    return law_text(law, rows)


def normal_template(law: Any) -> Template:
    """Template of a normal-force law: x = [e, e'], out = [N, dN/de, dN/de', V, dV/de]."""
    shape = ("normal", structure(law))
    found = _found.get(shape)
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._normal import derive_normal

            return derive_normal(law)

        found = _found[shape] = get("normal", _content(law, structure(law), lambda: _normal_text(law)), derive)
    return found


def normal_bend_template(law: Any) -> Template | None:
    """Template of the functions at whose sign changes a normal-force law bends, of somebody else's type; or None.

    Facts: ``count`` of them, and which of e and e' are their ``arguments``.  What this package has bends where the
    contact opens, and that is a transition.
    """
    if type(law).__module__.startswith("fricmb."):
        return None
    shape = structure(law)
    key = ("normal bends", shape)
    found = _found.get(key)
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._normal import derive_normal_bends

            return derive_normal_bends(law)

        found = _found[key] = get("normal_bends", _content(law, shape, lambda: _normal_text(law)), derive)
    return found if found.facts["count"] else None


def _normal_text(law: Any) -> str:
    from fricmb.equations._normal import normal_text

    return normal_text(law)


def joint_template(joint: Any) -> Template:
    """Template of a joint's type; the layout of its output is that of ``integrate.mechanism.Joints``."""
    n = len(joint.local_coordinates()) + len(joint.drives())
    bare, dry = joint.bare(), joint.friction is not None
    shape = ("joint", structure(bare), n, dry)
    found = _found.get(shape)
    if found is None:

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._joint import derive_joint, joint_math

            return derive_joint(joint_math(joint, n), type(joint).__name__)

        content = _content(bare, structure(bare), lambda: _joint_text(joint, n))
        key = [*content, n, dry]
        found = _found[shape] = get("joint", key, derive)
    return found


def _joint_text(joint: Any, n: int) -> str:
    from fricmb.equations._joint import joint_math

    return joint_math(joint, n).text()


def place_template(body: Any) -> Template:
    """Template of a point fixed in a body of this type: x = coordinates, p = offset."""
    kind: type = type(body)
    shape = ("place", kind)
    found = _found.get(shape)
    if found is None:
        n = len(body.dof_names)

        def derive() -> tuple[dict[str, Any], str | None]:
            from fricmb.equations._joint import derive_place

            return derive_place(body, n, kind.__name__)

        content = [kind.__module__, kind.__qualname__, source_fingerprint(kind)]
        found = _found[shape] = get("place", content, derive)
    return found
