"""A scene as arrays, with names and energies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fricmb.errors import unknown_name
from fricmb.integrate.model.table_values import arguments, evaluate
from fricmb.integrate.problem import NORMAL_LAW, Floats, Problem, SparseLinear, Start, Templates
from fricmb.integrate.trajectory import MotionSamples
from fricmb.system._breakpoints import Switch
from fricmb.system._leaps import Leap, leap_times
from fricmb.system._lined import LinedStores
from fricmb.system._series import SeriesUse, stops_of
from fricmb.system._stored import Stored, stored_of
from fricmb.system._structure import Store
from fricmb.system._tables import Row


@dataclass(frozen=True, kw_only=True)
class System:
    """What an integrator gets, and what its results mean.

    Attributes
    ----------
    problem : Problem
    start : Start
        Declared initial state.
    contact_axes, state_names : tuple of tuple of str
        By contact: labels of its tangential directions and of the states of its law.
    axis_scale : tuple of tuple of float
        By contact: factor s of every row.  The problem holds s v and F/s of a law that is not isotropic, so that to an
        integrator it is; their power is that of v and F.
    stores : tuple of Store
        Potentials of elements.
    lined : tuple of LinedStores
        Those of elements along letters, many at a time.
    switches : tuple of Switch
        Functions of time whose sign changes have to be searched: see :meth:`problem_for`.
    series : tuple of SeriesUse
        Measured series, which runs stop at: see :meth:`problem_for`.
    leaps : tuple of Leap
        Prescribed positions that may jump: see :meth:`leaps_between`.
    """

    problem: Problem
    start: Start
    contact_axes: tuple[tuple[str, ...], ...]
    state_names: tuple[tuple[str, ...], ...]
    axis_scale: tuple[tuple[float, ...], ...]
    stores: tuple[Store, ...]
    lined: tuple[LinedStores, ...] = ()
    switches: tuple[Switch, ...] = ()
    series: tuple[SeriesUse, ...] = ()
    leaps: tuple[Leap, ...] = ()

    @property
    def dof_names(self) -> tuple[str, ...]:
        """Names of the degrees of freedom, in the order of q."""
        return self.problem.dof_names

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts."""
        return self.problem.contact_names

    def problem_for(self, t_start: float, t_end: float) -> Problem:
        """The problem with every instant between two times at which an expression of time switches.

        Expressions such as ``sign(sin(t))`` switch without end: their breakpoints are known for a given run alone.

        Raises
        ------
        SceneError
            If a prescribed position jumps on which something depends that its speed acts on, or a measured series does
            not reach over the run.
        """
        problem = self.problem
        if self.switches or self.series:
            signals = problem.signals
            stops, kinks = stops_of(self.series, t_start, t_end)
            inside = [s.instants(t_start, t_end, np.concatenate([stops, kinks])) for s in self.switches]
            stops = np.unique(np.concatenate([signals.breakpoints, stops, *inside]))
            problem = replace(problem, signals=replace(signals, breakpoints=stops, kinks=kinks))
        leap_times(self.leaps, problem, t_start, t_end)
        return problem

    def leaps_between(self, t_start: float, t_end: float) -> Floats:
        """Times at which prescribed positions jump, and with them what springs store."""
        return leap_times(self.leaps, self.problem_for(t_start, t_end), t_start, t_end) if self.leaps else np.zeros(0)

    def freedom(self, samples: MotionSamples) -> int:
        """Degrees of freedom, constraints taken off."""
        return len(samples.q)

    def reaction(self, joint: str, samples: MotionSamples) -> Floats:
        """Reactions of a joint (rows, n_t); there is none without joints."""
        raise unknown_name("joint", joint, ())

    def reactions(self, samples: MotionSamples) -> dict[str, Floats]:
        """Reactions of all joints by name."""
        return {}

    # -- energies -----------------------------------------------------------------------------------------------
    def kinetic(self, samples: MotionSamples) -> Floats:
        """Kinetic energy (n_t,)."""
        masses, v = self._masses, samples.v
        if masses is not None:
            energy: Floats = 0.5 * (masses @ (v * v))
            return energy
        return np.asarray(0.5 * np.einsum("it,it->t", v, self.problem.linear.M @ v))

    def potential(self, samples: MotionSamples) -> Floats:
        """Stored energy (n_t,): springs, normal-force laws, weight."""
        total = self._linear.energy(samples.q, self.signals(samples.t)[0])
        if (
            any(store.nonlinear is not None for store in self.stores)
            or (self.problem.contacts.normal == NORMAL_LAW).any()
        ):
            for _, value in self._each_potential(samples, linear=False):
                total += value
        return total

    @property
    def has_loads(self) -> bool:
        """Whether forces from outside do work that :meth:`delivered` knows."""
        return any(store.is_load and (store.K or store.f) for store in self.stores)

    def delivered(self, samples: MotionSamples) -> Floats:
        """Work (n_t,) of loads that are constant or linear in coordinates, but for a constant."""
        given: Floats = -self._given.energy(samples.q, self.signals(samples.t)[0])
        return given

    def rubbed(self, samples: MotionSamples) -> Floats:
        """Loss (n_c, n_t) of contacts by the centres of their cones, but for a constant."""
        found = np.zeros((len(self.contact_names), samples.t.size))
        u = self.signals(samples.t)[0]
        for store in (store for store in self.stores if store.rubs):
            x = np.array([_along(row, samples.q, u) for row in store.rows])
            for i, _, f in store.f:
                found[self.contact_names.index(store.name)] -= f * x[i]
        return found

    @cached_property
    def _masses(self) -> Floats | None:
        """The mass matrix where it is diagonal."""
        linear = self.problem.linear
        if not isinstance(linear, SparseLinear):
            diagonal = np.diagonal(linear.M).copy()
            return diagonal if np.count_nonzero(linear.M) == np.count_nonzero(diagonal) else None
        M = linear.csr("M")
        return M.diagonal() if M.is_diagonal() else None

    @cached_property
    def _linear(self) -> Stored:
        held = tuple(store for store in self.stores if store.is_held)
        return stored_of(held, self.lined, self._n_coordinates, self.problem.n_u)

    @cached_property
    def _given(self) -> Stored:
        loads = tuple(store for store in self.stores if store.is_load)
        return stored_of(loads, (), self._n_coordinates, self.problem.n_u)

    @property
    def _n_coordinates(self) -> int:
        """Number of coordinates that stores depend on."""
        return self.problem.n

    def potentials(self, samples: MotionSamples) -> dict[str, Floats]:
        """Stored energy of every element and of every contact with a normal-force law, by name."""
        return dict(self._each_potential(samples))

    def _each_potential(self, samples: MotionSamples, *, linear: bool = True) -> Iterator[tuple[str, Floats]]:
        u = self.signals(samples.t)
        contacts = self.problem.contacts
        pressed = np.flatnonzero(contacts.normal == NORMAL_LAW)
        X = np.zeros((0, samples.t.size))
        if pressed.size or len(self.problem.elements.table.address):
            X = np.concatenate([samples.t[None], samples.q, samples.v, u[0], u[1]])
        for lined in self.lined if linear else ():
            yield from lined.each(samples.q)
        for store in self.stores:
            held = linear and store.is_held
            if store.nonlinear is not None or (held and (store.K or store.f or store.constant)):
                yield store.name, self._stored(store, samples.q, u[0], X, held)
        for k in pressed:
            yield self.contact_names[k], _value(contacts.normal_table, int(k), X, 5)[3]

    def _stored(self, store: Store, q: Floats, u: Floats, X: Floats, linear: bool) -> Floats:
        value = np.zeros(q.shape[1])
        if linear:
            value += store.constant
            x = {i: _along(store.rows[i], q, u) for i in {k for i, j, _ in (*store.K, *store.f) for k in (i, j)}}
            for i, j, k in store.K:
                value += 0.5 * k * x[i] * x[j]
            for i, _, f in store.f:
                value -= f * x[i]
        if store.nonlinear is not None:
            elements = self.problem.elements
            n_f = int(elements.f_start[store.nonlinear + 1] - elements.f_start[store.nonlinear])
            n_x = int(elements.table.x_start[store.nonlinear + 1] - elements.table.x_start[store.nonlinear])
            at = n_f * (1 + n_x)
            value += _value(elements.table, store.nonlinear, X, at + 3)[at]
        return value

    def signals(self, t: Floats) -> Floats:
        """Signals of the problem with two derivatives, (3, n_u, n_t)."""
        table = self.problem.signals.table
        values = np.zeros((3, len(table.address), t.size))
        for j in range(len(table.address)):
            values[:, j] = evaluate(table, j, t[:, None], 3)
        return values


def _along(row: Row, q: Floats, u: Floats) -> Floats:
    value = np.full(q.shape[1], row.constant)
    for i, c in row.q:
        value += c * q[i]
    for j, c in row.u:
        value += c * u[j]
    return value


def _value(table: Templates, k: int, X: Floats, n_out: int) -> Floats:
    return evaluate(table, k, arguments(table, k, X), n_out)
