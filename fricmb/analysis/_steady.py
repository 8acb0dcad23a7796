"""Steady sliding: the equilibrium of a scene whose contacts all slide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._calls import answers
from fricmb.analysis._errors import AnalysisError, Floats, checked_number, checked_scene, refuse
from fricmb.analysis._linearise import Linearised, linearise
from fricmb.analysis._track import Pairs, eigenpairs
from fricmb.errors import unknown_name
from fricmb.integrate.problem import LAW_SMOOTH, Ints
from fricmb.system import MechanismSystem, System, build

if TYPE_CHECKING:
    from fricmb.scene import Scene

_MOST_STEPS = 60


@dataclass(frozen=True, kw_only=True, repr=False)
class SteadySliding:
    """Equilibrium of a scene in steady sliding.

    Attributes
    ----------
    scene : Scene
    q, v : (n_dof,)
        Positions and velocities, in the order of ``scene.dof_names``.
    z : (n_z,)
        Law states.
    held : tuple of str
        Degrees of freedom whose speed was prescribed.
    acceleration : dict of str to float
        Acceleration that the unbalanced forces would give to those that are held: a measure of how steady the sliding
        is.
    """

    scene: Any
    system: System
    q: Floats
    v: Floats
    z: Floats
    held: tuple[str, ...]
    acceleration: dict[str, float]
    at: Linearised

    def __str__(self) -> str:
        """A table of degrees of freedom and one of contacts."""
        rows = [f"{'degree of freedom':24} {'position':>13} {'velocity':>13}"]
        for i, name in enumerate(self.system.dof_names):
            held = f"  held, acceleration {self.acceleration[name]:.3g}" if name in self.acceleration else ""
            rows.append(f"{name:24} {self.q[i]:13.6g} {self.v[i]:13.6g}{held}")
        rows += ["", f"{'contact':24} {'normal force':>13} {'slip speed':>13} {'friction':>13}"]
        for name in self.system.contact_names:
            slip, force = (np.linalg.norm(value) for value in (self.relative_velocity(name), self.force(name)))
            rows.append(f"{name:24} {self.normal_force(name):13.6g} {slip:13.6g} {force:13.6g}")
        return "\n".join(rows)

    def __repr__(self) -> str:
        return f"SteadySliding of {self.scene.name!r}: {len(self.q)} degrees of freedom, {len(self.at.N)} contacts"

    def position(self, name: str) -> float:
        """Position of a degree of freedom."""
        return float(self.q[self._index(name)])

    def normal_force(self, contact: str) -> float:
        """Normal force of a contact."""
        return float(self.at.N[self._contact(contact)])

    def force(self, contact: str) -> Floats:
        """Friction force (d,) on the contact's first end."""
        return self.at.F[self._rows(contact)]

    def relative_velocity(self, contact: str) -> Floats:
        """Velocity (d,) of the first end relative to the second."""
        return self.at.g[self._rows(contact)]

    def initial(self, *, push: Mapping[str, float] | None = None) -> dict[str, dict[str, float]]:
        """State for ``simulate(initial=...)``; ``push`` is added to velocities by name of degrees of freedom."""
        names = self.system.dof_names
        velocity = dict(zip(names, self.v.tolist(), strict=True))
        for name, value in (push or {}).items():
            velocity[names[self._index(name)]] += float(value)
        state: dict[str, Any] = {"position": dict(zip(names, self.q.tolist(), strict=True)), "velocity": velocity}
        starts = self.system.problem.contacts.z_start
        if self.z.size:
            state["state"] = {
                name: self.z[starts[k] : starts[k + 1]]
                for k, name in enumerate(self.system.contact_names)
                if starts[k + 1] > starts[k]
            }
        return state

    @property
    def free(self) -> Ints:
        """Places of the degrees of freedom that are not held."""
        return np.array([i for i, name in enumerate(self.system.dof_names) if name not in self.held], dtype=np.int64)

    def matrix(self) -> Floats:
        """The state matrix A of ``y' = A y`` around it, y = (q, v, z) of the free degrees of freedom."""
        n, i = len(self.q), self.free
        columns = np.concatenate([i, n + i, 2 * n + np.arange(self.z.size)]).astype(np.int64)
        M = self.system.problem.linear.M[np.ix_(i, i)]
        top = np.hstack([np.zeros((i.size, i.size)), np.eye(i.size), np.zeros((i.size, self.z.size))])
        middle = np.linalg.solve(M, self.at.force_y[np.ix_(i, columns)]) if i.size else np.zeros((0, columns.size))
        return np.vstack([top, middle, self.at.rate_y[:, columns]])

    def eigenpairs(self) -> Pairs:
        """Eigenvalues of :meth:`matrix` and unit eigenvectors by rows, which begin with ``free``."""
        return eigenpairs(self.matrix())

    def _index(self, name: str) -> int:
        names = self.system.dof_names
        if name not in names:
            raise unknown_name("degree of freedom", name, names)
        return names.index(name)

    def _contact(self, name: str) -> int:
        names = self.system.contact_names
        if name not in names:
            raise unknown_name("contact", name, names)
        return names.index(name)

    def _rows(self, contact: str) -> slice:
        k, row = self._contact(contact), self.system.problem.contacts.row
        return slice(int(row[k]), int(row[k + 1]))


@answers
def steady_sliding(scene: Scene, *, speeds: Mapping[str, float] | None = None) -> SteadySliding:
    """The equilibrium of a scene while all of its contacts slide.

    Parameters
    ----------
    scene : Scene
        Sliding comes from driven bodies, from ``slide`` of contacts, or from ``speeds``.
    speeds : dict of str to float, optional
        Degrees of freedom that move with a given speed and are held at it, such as a rotor that is slowed so little
        that its speed counts as constant: ``{"rotor.x": 10.0}``.  All others are at rest.

    Returns
    -------
    SteadySliding

    Raises
    ------
    AnalysisError
        If a contact does not slide, no equilibrium is found, or forces depend on time; says which.
    UnknownNameError
        For a speed of something that is no degree of freedom.

    Notes
    -----
    Newton's method with the analytic Jacobian of the scene, from its initial positions; a free rigid motion stays where
    it starts.
    """
    system = build(checked_scene("steady_sliding", scene))
    held = dict(checked_speeds(speeds))
    for name in held:
        if name not in system.dof_names:
            raise unknown_name("degree of freedom in speeds", name, system.dof_names)
    if isinstance(system, MechanismSystem):
        from fricmb.analysis._steady_motion import steady_motion

        return steady_motion(scene, system, held)
    v = np.array([float(held.get(name, 0.0)) for name in system.dof_names])
    free = np.array([i for i, name in enumerate(system.dof_names) if name not in held], dtype=np.int64)
    q, z = _solve(system, v, free)
    at = linearise(system, q, v, z)
    _check(system, at, q, v, z, free)
    moves = [i for i, name in enumerate(system.dof_names) if name in held]
    pull = np.linalg.solve(system.problem.linear.M, at.force) if moves else at.force
    return SteadySliding(
        scene=scene,
        system=system,
        q=q,
        v=v,
        z=z,
        held=tuple(held),
        acceleration={system.dof_names[i]: float(pull[i]) for i in moves},
        at=at,
    )


def checked_speeds(speeds: Any) -> Mapping[str, float]:
    """Speeds by names."""
    who, accepted = "steady_sliding", "a dict of names and speeds, finite numbers"
    if speeds is None:
        return {}
    if not isinstance(speeds, Mapping):
        refuse(who, "speeds", speeds, accepted)
    for value in speeds.values():
        checked_number(who, "speeds", value, accepted, np.isfinite)
    return dict(speeds)


def _solve(system: System, v: Floats, free: Ints) -> tuple[Floats, Floats]:
    """Positions and law states at which nothing accelerates, by damped Newton steps."""
    n = v.size
    q, z = system.start.q.copy(), system.start.z.copy()
    columns = np.concatenate([free, 2 * n + np.arange(z.size)]).astype(np.int64)
    residual = _residual(system, q, v, z, free)
    for _ in range(_MOST_STEPS):
        at = linearise(system, q, v, z)
        J = np.vstack([at.force_y[np.ix_(free, columns)], at.rate_y[:, columns]])
        step = -np.linalg.lstsq(J, residual, rcond=None)[0] if J.size else np.zeros(0)
        share = 1.0
        while True:
            q_next, z_next = q.copy(), z + share * step[free.size :]
            q_next[free] += share * step[: free.size]
            following = _residual(system, q_next, v, z_next, free)
            if np.linalg.norm(following) <= (1 - 0.1 * share) * np.linalg.norm(residual) or share < 1e-3:
                break
            share /= 2
        small = np.abs(step).max(initial=0.0) <= 1e-14 * max(1.0, float(np.abs(q).max(initial=0.0)))
        if np.linalg.norm(following) < np.linalg.norm(residual):
            q, z, residual = q_next, z_next, following
        elif small or share < 1e-3:
            break
        if small:
            break
    return q, z


def _residual(system: System, q: Floats, v: Floats, z: Floats, free: Ints) -> Floats:
    at = linearise(system, q, v, z)
    return np.concatenate([at.force[free], at.rate])


def check_slides(system: System, at: Linearised) -> None:
    """Refuse contacts that stick."""
    for k, name in enumerate(system.contact_names):
        if at.r[k] == 0.0 and at.N[k] > 0.0 and system.problem.contacts.law[k] != LAW_SMOOTH:
            raise AnalysisError(
                f"steady_sliding: contact {name!r} does not slide; drive one of its ends, give it slide=, or give"
                " speeds={...}"
            )


def _check(system: System, at: Linearised, q: Floats, v: Floats, z: Floats, free: Ints) -> None:
    """Refuse what is no steady sliding."""
    names = system.dof_names
    check_slides(system, at)
    scale = _scale(system, at, q)
    off = np.abs(at.force[free])
    if off.size and off.max() > 1e-9 * scale:
        worst = int(free[np.argmax(off)])
        raise AnalysisError(
            f"steady_sliding: no equilibrium; {names[worst]} is left with a force of {at.force[worst]:.4g}; if it moves"
            f" at a speed that counts as constant, give speeds={{{names[worst]!r}: ...}}"
        )
    for t in (1.0, 2.718281828):
        later = linearise(system, q, v, z, t).force[free]
        if later.size and np.abs(later - at.force[free]).max() > 1e-9 * scale:
            worst = int(free[np.argmax(np.abs(later - at.force[free]))])
            raise AnalysisError(f"steady_sliding: the force on {names[worst]} depends on time")


def _scale(system: System, at: Linearised, q: Floats) -> float:
    """Size of the forces that balance."""
    linear, n = system.problem.linear, q.size
    friction = np.abs(system.problem.contacts.W) @ np.abs(at.F)
    terms = [np.abs(linear.Kx[:n, :n]) @ np.abs(q), np.abs(linear.fx[:n]), friction, np.abs(at.N)]
    return max(float(np.max([term.max(initial=0.0) for term in terms])), 1e-300)
