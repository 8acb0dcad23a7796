"""From a scene to arrays."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable, Sequence
from functools import partial
from typing import Any, TypeVar

import numpy as np

from fricmb.equations import Signal
from fricmb.integrate.problem import Contacts, Floats, Input, Linear, Problem, Start
from fricmb.integrate.problem import Signals as SignalArrays
from fricmb.scene import Body, Contact, Element, Gravity, MatrixElement, ModalBody, Part, Scene
from fricmb.scene._family import NUMBERS, STARTS, of_same_parts
from fricmb.scene._family_of import SMALL
from fricmb.scene._lines import lines_of
from fricmb.system import _motions
from fricmb.system._bends import bends_of
from fricmb.system._breakpoints import switches_of
from fricmb.system._contacts import ContactArrays
from fricmb.system._gravity import add_gravity
from fricmb.system._inputs import forces_of, inputs_of
from fricmb.system._leaps import leaps_of
from fricmb.system._lined import Chosen, add_lines, choose
from fricmb.system._lost import check_digits
from fricmb.system._mechanism import build_mechanism
from fricmb.system._motions import Signals
from fricmb.system._series import series_of
from fricmb.system._shares import add_share, is_equal_but_start, shares_of
from fricmb.system._spectrum import check_mass, check_masses, spectrum, uncoupled_spectrum
from fricmb.system._structure import Structure, check_initial
from fricmb.system._system import System
from fricmb.values._pause import no_collection


def build(scene: Any, plan: Any = None) -> System:
    """The arrays of a scene.

    Parameters
    ----------
    scene : Scene
    plan : Plan or Selection, optional
        What to build: degrees of freedom and parts; default: everything.

    Returns
    -------
    System
        Kept with the scene: the same object for the same scene and plan.

    Raises
    ------
    SceneError
        If a declaration cannot become equations: a singular mass matrix, a point spring whose ends coincide, a driven
        body whose position has no closed form, an expression that cannot be compiled.
    """
    if plan is not None and len(plan.parts) == len(scene.parts) and len(plan.dofs) == len(scene.dof_names):
        plan = None
    key = ("system", None if plan is None else plan.key)
    found = scene._cache.get(key)
    if found is None:
        with no_collection(len(scene.parts)):
            found = scene._cache[key] = _build(scene, plan)
    return found  # type: ignore[no-any-return]


#: Above this no spectrum is computed.
SPECTRUM = 500


def _check_mass(linear: Linear, dofs: Sequence[str]) -> None:
    if _is_small(linear, len(dofs)):
        check_mass(linear.M, dofs)
    else:
        check_masses(linear.csr("M").diagonal(), dofs)


def _is_small(linear: Linear, n: int) -> bool:
    return n <= SPECTRUM or not linear.csr("M").is_diagonal()


def _spectrum(linear: Linear, n: int) -> tuple[Floats, Floats]:
    """Frequencies and damping ratios; none for large coupled structures."""
    if _is_small(linear, n):
        return spectrum(linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n])
    M = linear.csr("M")
    K, C = (linear.csr(name).block(slice(0, n), slice(0, n)) for name in ("Kx", "Cx"))
    if K.is_diagonal() and C.is_diagonal():
        return uncoupled_spectrum(M.diagonal(), K.diagonal(), C.diagonal())
    return np.zeros(0), np.zeros(0)


def _build(scene: Any, plan: Any) -> System:
    if scene.is_mechanism:
        return build_mechanism(scene, plan)
    dofs = scene.dof_names if plan is None else plan.dofs
    signals = _motions.Signals()
    motions = _motions.Motions(scene, {name: i for i, name in enumerate(dofs)}, signals)
    parts = scene.parts if plan is None else [scene[name] for name in plan.parts]
    chosen = choose(scene, parts, dofs)
    standing = [part for part in parts if not isinstance(part, Contact) or part.law.offsets()]
    touching = [part for part in parts if not isinstance(part, Element | MatrixElement | Gravity)]
    structure = half_of(
        scene, ("structure", dofs), standing, signals, lambda: _structure(scene, motions, parts, chosen), STARTS
    )
    contacts = half_of(
        scene, ("contacts", dofs), touching, signals, lambda: _contacts(scene, motions, chosen), NUMBERS
    )
    motions.forget_scene()
    return _system(scene, dofs, structure, contacts, signals)


def _structure(scene: Any, motions: _motions.Motions, parts: Sequence[Any], chosen: Chosen) -> Structure:
    structure = Structure(motions=motions)
    shares = shares_of(scene, ("structure", tuple(motions.dofs)))
    odd = add_lines(structure.lined, scene, chosen)
    for part in (*chosen.single, *odd):
        if isinstance(part, Body | ModalBody):
            add_share(shares, part, structure, structure.add_body, is_equal_but_start)
        elif isinstance(part, MatrixElement):
            structure.add_matrix(part)
        elif isinstance(part, Element):
            add_share(shares, part, structure, structure.add_element)
        elif isinstance(part, Gravity):
            add_gravity(part, parts, structure)
    for run, lined in chosen.runs:
        for within in (w for contact in run for w in contact.parts_within()) if lined is None else ():
            structure.add_element(within)
    return structure


def _contacts(scene: Any, motions: _motions.Motions, chosen: Chosen) -> tuple[ContactArrays, Contacts]:
    contacts = ContactArrays(motions=motions)
    shares = shares_of(scene, ("contacts", tuple(motions.dofs)))
    for run, lined in chosen.runs:
        if lined is not None:
            contacts.add_lined(run, lined, lines_of(scene).motions, chosen.place)
            continue
        for contact in run:
            add_share(shares, contact, contacts, contacts.add)
    return contacts, contacts.build(len(motions.dofs), len(motions.signals.held))


def _problem_in_use(structure: Structure, touching: tuple[ContactArrays, Contacts]) -> Problem | None:
    """That of another scene which nothing tells from this one but where it starts, while somebody has it.

    A family of small scenes has its last one.
    """
    linear, _ = structure.arrays(0)
    found = linear.kept.get("problem", lambda: None)()
    return found if found is not None and found.contacts is touching[1] else None


def _problem(
    dofs: tuple[str, ...], structure: Structure, touching: tuple[ContactArrays, Contacts], signals: _motions.Signals,
    breakpoints: Floats, inputs: tuple[Input, ...],
) -> Problem:  # fmt: skip
    n, n_u = len(dofs), len(signals.held)
    linear, elements = structure.arrays(n_u)
    if not structure.has_plain_masses:
        _check_mass(linear, dofs)
    check_digits(structure.stores, structure.lined.stores, linear.csr("Kx").diagonal()[:n], structure.motions.dofs)
    contacts, contact_arrays = touching
    table = signals.table.build(n, n_u)
    problem = Problem(
        linear=linear,
        signals=SignalArrays(
            table=table, breakpoints=breakpoints, uniform=signals.uniform(), inputs=inputs,
            forces=forces_of([(s.template, s.parameters[:-1]) for s in signals.held]),
        ),
        contacts=contact_arrays,
        elements=elements,
        bends=bends_of((*structure.bends, *contacts.bends), n, n_u),
        spectrum=partial(_spectrum, linear, n),
        dof_names=dofs,
        contact_names=tuple(contacts.names),
    )
    linear.kept["problem"] = weakref.ref(problem)
    return problem


def _system(
    scene: Any, dofs: tuple[str, ...], structure: Structure, touching: tuple[ContactArrays, Contacts],
    signals: _motions.Signals,
) -> System:  # fmt: skip
    contacts, _ = touching
    timed = [(s.template, s.parameters[:-1]) for s in signals.held] + contacts.timed + structure.timed
    known, searched = switches_of(timed)
    problem = _problem_in_use(structure, touching) if not timed else None
    if problem is None:
        problem = _problem(dofs, structure, touching, signals, known, inputs_of(timed))
        if len(scene.parts) <= SMALL:
            scene._shared["problem"] = problem
    q, v = scene.initial_values(dofs)
    system = System(
        problem=problem,
        start=Start(t=0.0, q=q, v=v, z=np.zeros(problem.n_z)),
        contact_axes=tuple(contacts.labels),
        state_names=tuple(contacts.states),
        axis_scale=tuple(contacts.scale),
        stores=tuple(structure.stores),
        lined=tuple(structure.lined.stores),
        switches=searched,
        series=series_of(timed, scene),
        leaps=leaps_of(scene, signals.index),
    )
    if structure.nonlinear:
        u = system.signals(np.zeros(1))[0, :, 0]
        for element, rows in structure.nonlinear:
            check_initial(element, rows, q, u)
    return system


_T = TypeVar("_T")


def half_of(
    scene: Scene, key: tuple[Hashable, ...], parts: Sequence[Part], signals: Signals, build: Callable[[], _T],
    but: frozenset[str],
) -> _T:  # fmt: skip
    """What ``build`` makes of some parts, or made of them for another scene; what it adds to the signals is added.

    ``key``: which half it is, and for which degrees of freedom; ``but``: fields of bodies that it does not depend on.
    """
    before = tuple(signals.index)

    def make() -> tuple[list[tuple[str, Signal]], _T]:
        built = build()
        return list(zip(signals.index, signals.held, strict=True))[len(before) :], built

    added, built = of_same_parts(scene, (*key, before), parts, make, but=but)
    for name, signal in added[len(signals.index) - len(before) :]:  # none of what was built just now
        signals.put(name, signal)
    return built
