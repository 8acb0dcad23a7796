"""A run and the statements of its scene side by side: what is said at the times of the run."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.field._contacts import Presses, Rubs
from fricmb.field._motions import Frame, Moment
from fricmb.field._parts import Acting, Found, Joins, acting, least_masses, masses
from fricmb.integrate.problem import SLIP, Floats
from fricmb.integrate.trajectory import Samples
from fricmb.scene import Contact, Joint
from fricmb.scene._space_body import with_inner


def frame_of(names: Any, piece: Any) -> Frame:
    """What tells the motions of one piece of a run."""
    scene = piece.mechanics.placed

    def driven(name: str, t: Floats) -> Floats:
        position, _ = piece.mechanics.signals(t)
        found: Floats = position[names.signals[name]]
        return found

    breaks = piece.trajectory.breakpoints if scene.is_mechanism else np.zeros(0)
    return Frame(scene=scene, index=dict(names.dof_index), driven=driven, breaks=breaks)


class Statements:
    """The equations of one piece of a run.

    Attributes
    ----------
    mass : (n,)
        Diagonal of the mass matrix.
    weight : (n,)
        What changes are measured by: the same, and above 0 also where a coordinate has no mass.
    contacts : dict of int to Rubs
        By place in the run.
    """

    def __init__(self, sol: Any, piece: Any) -> None:
        self.names = sol.names
        self.piece = piece
        mechanics = piece.mechanics
        scene, held = mechanics.placed, set(mechanics.plan.parts)
        index = dict(self.names.dof_index)
        self.scene = scene
        self.frame = frame_of(self.names, piece)
        self.mass, self.mass_matrices = masses(scene, held, index)
        self.weight = np.maximum(self.mass, least_masses(scene, index))
        numbers = self.names.contact_index
        self.contacts: dict[int, Rubs] = {}
        self.acting: list[Acting] = []
        self.joints: list[Joins] = []
        for part in with_inner(part for part in scene.parts if part.name in held):
            k = numbers.get(part.name)
            if k is not None and isinstance(part, Contact | Joint) and part.law is not None:
                steady = isinstance(part, Contact) and part.normal_kind == "constant"
                self.contacts[k] = Rubs(part.name, part.law, steady)
            found: Acting | None
            if isinstance(part, Contact):
                rows = slice(int(self.names.row[k]), int(self.names.row[k + 1])) if k is not None else slice(0, 0)
                found = Presses(part, k, rows) if k is not None else None
            else:
                found = acting(scene, part, index, k, -1 if k is None else int(self.names.row[k]))
            if isinstance(found, Joins):
                self.joints.append(found)
            if found is not None:
                self.acting.append(found)

    def moment(self, samples: Samples) -> Moment:
        """Samples of the run as a moment; forces in the units of the user."""
        lam = self.piece.mechanics.reactions(samples) if self.joints else {}
        return Moment(
            frame=self.frame, t=samples.t, q=samples.q, v=samples.v, z=samples.z,
            F=samples.F * self.names.row_scale, N=samples.N, mode=samples.mode, lam=lam,
        )  # fmt: skip

    def found(self, moment: Moment) -> Found:
        """What the statements say of a moment."""
        found = Found(force=np.zeros_like(moment.q))
        for part in self.acting:
            part.add(moment, found)
        for k, law in self.contacts.items():
            if law.law.states:
                found.rate[k] = law.rate(found.g[k], found.N[k], self.states(moment, k))
        return found

    def states(self, moment: Moment, k: int) -> Floats:
        """States of a contact's law."""
        rows: Floats = moment.z[self.names.z_start[k] : self.names.z_start[k + 1]]
        return rows

    def forces(self, moment: Moment, k: int) -> Floats:
        """Friction of a contact."""
        rows: Floats = moment.F[self.names.row[k] : self.names.row[k + 1]]
        return rows

    def whole_forces(self, moment: Moment, found: Found, k: int) -> Floats:
        """The same, with what the centre of its cone brings to the losses."""
        offsets = self.contacts[k].offsets
        rows = self.forces(moment, k)
        return rows if offsets is None else rows - offsets * found.N[k]

    def said(self, moment: Moment, found: Found) -> Floats:
        """Friction (m, n_t) as the laws give it in slip, of force laws always; 0 where a contact sticks or is open."""
        F = np.zeros_like(moment.F)
        for k, law in self.contacts.items():
            own = slice(int(self.names.row[k]), int(self.names.row[k + 1]))
            force = law.force(found.g[k], found.N[k], self.states(moment, k))
            F[own] = force if law.smooth else np.where(moment.mode[k] == SLIP, force, 0.0)
        return F

    def momentum(self, v: Floats) -> Floats:
        """Momentum (n, n_t) of velocities."""
        found = self.mass[:, None] * v
        for rows, M in self.mass_matrices:
            found[rows] += M @ v[rows]
        return found

    def jump(self, begin: Samples, end: Samples) -> Floats:
        """Rows as those of :class:`Weak`: what a jump of friction somewhere between two samples can bring (.., n_t)."""
        found = self.found(self.moment(begin))
        h = end.t - begin.t
        step = (np.abs(end.F - begin.F) + np.abs(end.F) + np.abs(begin.F)) * self.names.row_scale
        speed = np.maximum(np.abs(end.g), np.abs(begin.g)) / self.names.row_scale
        push, loss = np.zeros_like(begin.q), []
        for k in self.contacts:
            own = slice(int(self.names.row[k]), int(self.names.row[k + 1]))
            for row, force in zip(found.rows[k], step[own], strict=True):
                for i, c in row:
                    push[i] += np.abs(c) * force * h
            loss.append((step[own] * speed[own]).sum(axis=0) * h)
        states = np.zeros((sum(len(self.states_of(k)) for k in self.contacts), h.size))
        losses = np.array(loss).reshape(len(loss), h.size)
        return np.concatenate([push, np.abs(push) / self.weight[:, None] * h, states, losses])

    def states_of(self, k: int) -> range:
        """Rows of the states of a contact's law."""
        return range(int(self.names.z_start[k]), int(self.names.z_start[k + 1]))
