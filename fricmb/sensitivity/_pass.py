"""The tangent pass: the variational equations along a finished run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fricmb._simulate._asked import STATE
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Samples
from fricmb.scene import RigidBody
from fricmb.sensitivity._bends import bends_of
from fricmb.sensitivity._collocation import radau
from fricmb.sensitivity._constrained import Constrained
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._formula_switches import formula_switches
from fricmb.sensitivity._happenings import PASS, Happening, happenings
from fricmb.sensitivity._impacts import check_open
from fricmb.sensitivity._landings import extrapolated, near_misses, passes, places_before, settled
from fricmb.sensitivity._mesh import STAGES, Stepper, mesh_of
from fricmb.sensitivity._phases import phases_of
from fricmb.sensitivity._setting_out import SettingOut, set_outs
from fricmb.sensitivity._starts import held, one_sided
from fricmb.sensitivity._steep import steep
from fricmb.sensitivity._transitions import Transitions

#: More states than this are not carried: maps of steps are dense, and take a third of a second each at this size.
MOST = 300


#: Of bodies that turn names of initial values as they are declared.
_TURNS = {"position.angle": "angle", "velocity.angle": "angular_velocity"}


class Tangent:
    """Derivatives of a run at any time.

    Attributes
    ----------
    columns : tuple of str
        What derivatives are with respect to: initial values first, where they are asked for.
    event_times : (n_events, n_columns)
        Derivatives of the times of events; ``transversality`` (n_events,).
    notes : tuple of str
    unsafe : tuple of int
        Numbers of events at which there is no derivative, or almost none.
    """

    def __init__(self, sol: Any, names: tuple[str, ...]) -> None:
        (piece,) = sol.run.pieces
        self.parameters = tuple(name for name in names if name != STATE)
        kind = Constrained if piece.mechanics.placed.is_mechanism else Equations
        self.equations: Equations = kind(piece, sol.names, self.parameters)
        _check(sol, self.equations)
        e = self.equations
        if isinstance(e, Constrained):
            check_open(piece, e.struck)
        self.states = state_names(sol.names) if STATE in names else ()
        self.columns = (*self.states, *self.parameters)
        sample = piece.trajectory.motion
        breakpoints = e.breakpoints
        transitions_at = np.asarray(sol.events.transitions.t)
        self.phases = phases_of(piece, transitions_at, sol.names.row, breakpoints.t, np.zeros(0))
        bends = bends_of(e, self.phases, sample)
        if bends.t.size:
            self.phases = phases_of(piece, transitions_at, sol.names.row, breakpoints.t, bends.t)
        self.switches = formula_switches(e, self.phases, sample, bends)
        self.rtol = sol.stats.rtol or 1e-6
        self.stepper = Stepper(e, self.phases, sample)
        scale = sizes(sample(self.phases.t), np.diagonal(e.weights), [len(own) for own in e.names.states])
        stops = np.union1d(np.union1d(transitions_at, breakpoints.t), bends.t)
        setting_out = SettingOut(e, self.phases, sample, scale, self.rtol)
        solved = [
            step for one in set_outs(e, self.phases, self.stepper.rests, stops) for step in setting_out.steps(*one)
        ]
        self.mesh = mesh_of(self.stepper, scale, self.rtol, solved)
        passed = passes(e, self.stepper.rests)
        happened = happenings(sol.events.transitions, sol.names, self.phases, breakpoints.moving(), passed)
        rows = piece.trajectory.row_motion()
        transitions = Transitions(
            e, self.phases, sample, happened, breakpoints, self.rtol, rows, sol.events.transitions
        )
        mode, S = self.phases.mode[:, 0], self._begin()
        first = e.said(sample(self.phases.t[:1]), mode[:, None], self.phases.sign[:, :1])
        S = e.settled(first, S)
        one_sided_by, S = one_sided(e, first, mode, S), held(e, first, 0, mode, S)
        self._march(S, transitions, len(sol.events.transitions))
        starts = [
            f"contact {name!r} starts at rest and slips from there on: derivatives with respect to"
            f" {', '.join(repr(self.columns[j]) for j in by)}, which give it a speed, are one-sided"
            for name, by in one_sided_by.items()
        ]
        self.notes = (*starts, *setting_out.notes, *transitions.notes, *self._unsure(sample, happened, passed))

    def _unsure(
        self, sample: Any, happened: list[Happening], passed: list[tuple[int, int]]
    ) -> Iterator[str]:
        """Notes of what the errors of the run leave open."""
        e, rtol = self.equations, self.rtol
        for switch in self.switches.values():
            if not switch.sound:
                yield (
                    f"at t = {switch.t:.10g} rates of states jump where a formula hardly switches, or by a reaction:"
                    " derivatives of what follows are not sound"
                )
        taken = {(one.contacts[0], one.phase) for one in happened if one.kinds == [PASS]}
        for k, phase in (one for one in passed if one not in taken):
            yield (
                f"at t = {self.phases.t[phase]:.10g} slip of contact {e.names.contacts[k]!r} passes rest while"
                " something else happens: derivatives of what follows are not sound"
            )
        for k, t, share in near_misses(e, self.phases, sample, passed):
            yield (
                f"at t = {t:.10g} slip of contact {e.names.contacts[k]!r} passes rest at {share:.0e} of its largest"
                f" speed: derivatives of what follows may be off by {min(rtol / share, 1.0):.0e} of their size"
            )
        for k, off in steep(e, self.stepper, self.mesh):
            yield (
                f"friction of contact {e.names.contacts[k]!r} falls so steeply near rest that derivatives may be off by"
                f" {min(off * rtol, 1.0):.0e} of their size"
            )

    def _begin(self) -> Floats:
        """Derivatives of the initial state (n_y, columns)."""
        e = self.equations
        S = np.zeros((e.n_y, len(self.columns)))
        S[:, : len(self.states)] = np.eye(e.n_y)[:, : len(self.states)]
        for row, name in enumerate(state_names(e.names)[: 2 * e.n]):
            body, _, path = name.partition(".")
            path = _TURNS.get(path, path) if isinstance(e.scene[body], RigidBody) else path
            held = e.scene[body].slots().get(path)
            if held is None:
                slopes = {e.seeds.columns[name]: 1.0} if name in e.seeds.columns else {}
            else:
                slopes = e.seeds.dual(held, f"{body}.{path}").slopes
            for j, slope in slopes.items():
                S[row, len(self.states) + j - e.n_y] = slope
        return S

    def _march(self, S: Floats, transitions: Transitions, n_events: int) -> None:
        """From step to step and over the transitions."""
        n_y, n_s = self.equations.n_y, len(self.states)
        at = {one.phase: i for i, one in enumerate(transitions.happened)}
        # one more: for what happens without an event
        event_times, transversality = np.zeros((n_events + 1, len(self.columns))), np.full(n_events + 1, np.inf)
        self.before: dict[float, Floats] = {}
        found, last = np.empty((self.mesh.t.size + 1, n_y, len(self.columns))), 0
        for k, (phase, map_) in enumerate(zip(self.mesh.phase.tolist(), self.stepper.each(self.mesh), strict=True)):
            if phase != last and phase in at:
                i = at[phase]
                one = transitions.happened[i]
                self.before[one.t] = S
                S, dt = self._over(transitions, i, S, found, k)
                event_times[one.events] = dt
                transversality[one.events] = transitions.transversality(i)
                transitions.say_unsafe(i)
            elif phase != last and phase in self.switches:
                S = self.switches[phase].over(S)
            last = phase
            found[k] = S
            S = map_[:, :n_y] @ S
            S[:, n_s:] += map_[:, n_y:]
        found[-1] = S
        self.S, self.unsafe = found, tuple(sorted(transitions.unsafe - {n_events}))
        self.event_times, self.transversality = event_times[:-1], transversality[:-1]

    def _over(self, transitions: Transitions, i: int, S: Floats, held: Floats, k: int) -> tuple[Floats, Floats]:
        """Derivatives after a transition and of its time.

        Slip in two directions is followed to a time tau before it ends; what is projected there is off by a polynomial
        in tau without a constant, which projections at twice and four times that time tell.
        """
        rest = float(self.mesh.left_out[self.mesh.phase[k - 1]])
        if rest == 0.0 or transitions.landing(i) is None:
            return transitions.jump(i, S)
        t = transitions.happened[i].t
        places = places_before(t, rest, self.mesh.t[:k])
        tau, S_before = t - self.mesh.t[places], held[places]
        dts, noise = transitions.landing_times(i, S_before, self.stepper.sample(self.mesh.t[places]).g)
        dt, off = settled(tau, dts, noise)
        S_plus = [transitions.jump(i, *one)[0] for one in zip(S_before[:3], dts[:3], strict=True)]
        transitions.say_unsure(i, dt, off, self.columns)
        return extrapolated(np.tile(tau[:3, None], S.shape[0]), np.array(S_plus)), dt

    def at(self, t: Floats, *, left: Any = None) -> Floats:
        """Derivatives (n_t, n_y, columns) of the state at times; ``left``: where the values before a transition are."""
        k = np.clip(np.searchsorted(self.mesh.t, t, side="right") - 1, 0, self.mesh.t.size - 1)
        h = np.asarray(t - self.mesh.t[k])
        found = self.S[k].copy()
        ends = t >= self.phases.t[-1]
        found[ends] = self.S[-1]
        own = np.array([int(i) in self.mesh.solved for i in k], dtype=bool)
        far = np.flatnonzero((h > 0.0) & ~ends & ~own)
        n_y, n_s = self.equations.n_y, len(self.states)
        maps = self.stepper.maps(radau(STAGES), self.mesh.t[k[far]], h[far], self.mesh.phase[k[far]])
        found[far] = maps[..., :n_y] @ found[far]
        found[far, :, n_s:] += maps[..., n_y:]
        for j in np.flatnonzero((h > 0.0) & ~ends & own).tolist():
            step = self.mesh.solved[int(k[j])]
            map_ = step.map(float(h[j]) / step.h)
            found[j] = map_[:, :n_y] @ found[j]
            found[j, :, n_s:] += map_[:, n_y:]
        for i in np.flatnonzero(left) if left is not None else ():
            found[i] = self.before.get(float(t[i]), found[i])
        return found


def state_names(names: Any) -> tuple[str, ...]:
    """Names of all initial values: positions, velocities, states of laws."""
    dofs = [dof.partition(".") for dof in names.dofs]
    found = [f"{body}.{kind}.{path}" for kind in ("position", "velocity") for body, _, path in dofs]
    laws = [f"{c}.state.{s}" for c, held in zip(names.contacts, names.states, strict=True) for s in held]
    return (*found, *laws)


def _check(sol: Any, equations: Equations) -> None:
    """Refuse what the pass cannot do."""
    if sol.stats.rtol is None:
        raise SceneError(
            f"sensitivities: {sol.stats.method} does not locate transitions; take a method with a tolerance"
        )
    if equations.n_y > MOST:
        raise SceneError(
            f"sensitivities: the scene has {equations.n_y} states; the limit is {MOST}, because maps of steps are dense"
        )


#: Speeds count from this share of what all energy of motion would bring about in a coordinate, states of a law from
#: this share of the largest of the same contact.
_SHARE = 1e-4


def sizes(samples: Samples, mass: Floats, counts: Sequence[int]) -> Floats:
    """Sizes of q, v and z (n_y,) in a run; ``mass`` (n,) of the coordinates, ``counts`` of states by contact.

    What hardly moves, or by round-off alone, has the speed that a hundred-millionth of the energy would give it, and
    the way that this is in the longest step: else its relative error would decide how fine steps are.
    """
    energy = float((mass[:, None] * samples.v**2).sum(axis=0).max(initial=0.0))
    least = _SHARE * np.sqrt(energy / mass)
    v = np.maximum(np.abs(samples.v).max(axis=1, initial=0.0), least)
    q = np.maximum(np.abs(samples.q).max(axis=1, initial=0.0), least * np.diff(samples.t).max(initial=0.0))
    z = np.abs(samples.z).max(axis=1, initial=0.0)
    for own in np.split(z, np.cumsum(counts)[:-1]):
        own[:] = np.maximum(own, _SHARE * own.max(initial=0.0))
    return np.concatenate([np.where(x > 0.0, x, x.max(initial=0.0) or 1.0) for x in (q, v, z)])
