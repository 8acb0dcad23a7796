"""From a scene to arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Linear, Problem, Signals, Start
from fricmb.scene import Body, Element, Gravity, MatrixElement, ModalBody
from fricmb.scene._lines import lines_of
from fricmb.system import _motions
from fricmb.system._breakpoints import switches_of
from fricmb.system._contacts import ContactArrays
from fricmb.system._gravity import add_gravity
from fricmb.system._lined import add_lines, choose
from fricmb.system._mechanism import build_mechanism
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


def _spectrum(linear: Linear, n: int, dofs: Sequence[str]) -> tuple[Floats, Floats]:
    """Frequencies and damping ratios, none for large coupled structures, after a check of the mass matrix."""
    if n <= SPECTRUM or not linear.csr("M").is_diagonal():
        check_mass(linear.M, dofs)
        return spectrum(linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n])
    M = linear.csr("M")
    check_masses(M.diagonal(), dofs)
    K, C = (linear.csr(name).block(slice(0, n), slice(0, n)) for name in ("Kx", "Cx"))
    if K.is_diagonal() and C.is_diagonal():
        return uncoupled_spectrum(M.diagonal(), K.diagonal(), C.diagonal())
    return np.zeros(0), np.zeros(0)


def _build(scene: Any, plan: Any) -> System:
    if scene.is_mechanism:
        return build_mechanism(scene, plan)
    dofs = scene.dof_names if plan is None else plan.dofs
    index = {name: i for i, name in enumerate(dofs)}
    signals = _motions.Signals()
    motions = _motions.Motions(scene, index, signals)
    structure = Structure(n=len(dofs), motions=motions)
    contacts = ContactArrays(motions=motions)
    parts = scene.parts if plan is None else [scene[name] for name in plan.parts]
    chosen = choose(scene, parts, dofs)
    odd = add_lines(structure.lined, scene, chosen)
    for part in (*chosen.single, *odd):
        if isinstance(part, Body | ModalBody):
            structure.add_body(part, index)
        elif isinstance(part, MatrixElement):
            structure.add_matrix(part, index)
        elif isinstance(part, Element):
            structure.add_element(part)
        elif isinstance(part, Gravity):
            add_gravity(part, parts, structure, index)
    for run, lined in chosen.runs:
        if lined is not None:
            contacts.add_lined(run, lined, lines_of(scene).motions, chosen.place)
            continue
        for contact in run:
            contacts.add(contact)
    n, n_u = len(dofs), len(signals.held)
    linear = structure.linear(n_u)
    omega, zeta = _spectrum(linear, n, dofs)
    timed = [(s.template, s.parameters[:-1]) for s in signals.held] + contacts.timed + structure.timed
    known, searched = switches_of(timed)
    problem = Problem(
        linear=linear,
        signals=Signals(table=signals.table.build(n, n_u), breakpoints=known, uniform=signals.uniform()),
        contacts=contacts.build(n, n_u),
        elements=structure.elements(n_u),
        omega=omega,
        zeta=zeta,
        dof_names=dofs,
        contact_names=tuple(contacts.names),
    )
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
    )
    if structure.nonlinear:
        u = system.signals(np.zeros(1))[0, :, 0]
        for element, rows in structure.nonlinear:
            check_initial(element, rows, q, u)
    return system
