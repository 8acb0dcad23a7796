r"""Impacts: by how much they make derivatives jump.

An impact is where a gap g closes.  With f the rates of the state, S its derivatives by parameters p, and the law of
impact y+ = R(y-, t, p), its time moves by dt = -(g_y S- + g_p)/(g_y f- + g_t), and behind it (saltation)

.. math:: S^+ = R_y (S^- + f^- dt) + R_t dt + R_p - f^+ dt .

R solves the linear equations of the impact with what is known to slip and to stick in it:

.. math:: M \Delta - W \Lambda = 0, \quad W^T \Delta = -(1 + e)\,\gamma^-, \quad \Lambda_T = -\sigma \mu \Lambda_N

with e = 0 for what holds both ways; its slopes follow by differentiating them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene import impact_law
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._found import Held, at, total
from fricmb.sensitivity._happenings import Happening
from fricmb.sensitivity._motions import Row
from fricmb.sensitivity._struck import Meeting, Struck

#: Part of mu N by which friction in an impact that slips may miss it.
_FULL = 1e-9


@dataclass(frozen=True, kw_only=True)
class _Line:
    """A row of the equations of an impact: relative velocity ``rate`` along ``row``, restitution ``e``.

    ``slides``: (sign of slip, coefficient, number of the line of its normal impulse), None where it is stopped.
    """

    row: Row
    rate: Dual
    e: Dual
    slides: tuple[float, Dual, int] | None = None


class Impacts:
    """The impacts among the happenings of a run.

    Parameters
    ----------
    equations
        Their ``struck`` are the surfaces.
    meetings : dict
        By name, at the times of all happenings, with velocities before them.
    held : list of Held
        Constraints of joints, there.
    events
        Transitions of the run.
    """

    def __init__(
        self, equations: Any, happened: list[Happening], meetings: Mapping[str, Meeting], held: list[Held], events: Any
    ) -> None:
        self.equations, self.happened, self.meetings, self.held = equations, happened, meetings, held
        self.events = list(events)

    def hits(self, i: int) -> list[tuple[Any, Struck, Meeting]]:
        """What is hit in happening i: events, surfaces, and where they are."""
        one, found = self.happened[i], []
        for number, kind in zip(one.events.tolist(), one.kinds, strict=True):
            if kind == "impact":
                event = self.events[number]
                name = f"{event.contact}.{event.side}"
                name = name if name in self.meetings else event.contact
                found.append((event, self.equations.struck[name], self.meetings[name]))
        return found

    def times(self, i: int, before: Floats, S: Floats) -> list[Floats]:
        """Derivatives (n_p,) of the times at which gaps close; ``before`` (n_y,): rates of the state."""
        return [-total(slopes, S, self.equations.n_y) / rate for slopes, rate in self._closing(i, before)]

    def transversality(self, i: int, before: Floats, speed: Floats) -> list[float]:
        """Speeds of approach beside the largest that speeds (n,) of the run make."""
        found = []
        for (_, _, meeting), (_, rate) in zip(self.hits(i), self._closing(i, before), strict=True):
            found.append(abs(rate) / (sum(abs(_value(c, i)) * speed[k] for k, c in meeting.row) + 1e-300))
        return found

    def jump(self, i: int, S: Floats, dt: Floats, before: Floats, after: Floats) -> Floats:
        """Derivatives behind an impact from those before, with those of its time and rates on both sides."""
        e = self.equations
        moved = S + np.outer(before, dt)
        slopes = self._slopes(i)
        moved[e.n : 2 * e.n] += total(slopes, moved, e.n_y) + np.outer(slopes[:, -1], dt)
        found: Floats = moved - np.outer(after, dt)
        return found

    def _closing(self, i: int, before: Floats) -> list[tuple[Floats, float]]:
        """Slopes (columns,) and rates of gaps."""
        e, found = self.equations, []
        for _, _, meeting in self.hits(i):
            slopes = _line(meeting.gap, i, e.columns)
            found.append((slopes, float(slopes[: e.n_y] @ before + slopes[-1])))
        return found

    def _lines(self, i: int) -> list[_Line]:
        lines = [_Line(row=held.row, rate=held.rate, e=Dual(value=0.0)) for held in self.held]
        for event, struck, meeting in self.hits(i):
            normal = len(lines)
            lines.append(_Line(row=meeting.row, rate=meeting.rate, e=struck.restitution))
            if meeting.slip is None or meeting.slip_row is None:
                continue
            along, most = event.tangential_impulse, struck.mu.value * event.impulse
            full = abs(along) >= most * (1.0 - _FULL)
            slides = (-float(np.sign(along)), struck.mu, normal) if full else None
            lines.append(_Line(row=meeting.slip_row, rate=meeting.slip, e=struck.along, slides=slides))
        return lines

    def _slopes(self, i: int) -> Floats:
        """Slopes (n, columns) of the change of velocities by positions, velocities, states, parameters, time."""
        e, lines = self.equations, self._lines(i)
        n, m = e.n, len(lines)
        K, b = np.zeros((n + m, n + m)), np.zeros(n + m)
        K[:n, :n] = e.M
        for r, line in enumerate(lines):
            for k, c in line.row:
                K[k, n + r] -= _value(c, i)
            if line.slides is None:
                for k, c in line.row:
                    K[n + r, k] += _value(c, i)
                b[n + r] = -(1.0 + line.e.value) * at(line.rate.value, i)
            else:
                sign, mu, normal = line.slides
                K[n + r, n + r], K[n + r, n + normal] = 1.0, sign * mu.value
        inverse = np.linalg.pinv(K, rcond=1e-13) if m else np.linalg.inv(K)
        u = inverse @ b
        right = self._moved(i, lines, u)
        found: Floats = (inverse @ right)[:n]
        return found

    def _moved(self, i: int, lines: list[_Line], u: Floats) -> Floats:
        """Slopes (n + m, columns) of the equations' right-hand side less those of the matrix times u."""
        e, n = self.equations, self.equations.n
        right = np.zeros((u.size, e.columns))
        for k, other, j, slope in e.seeded_masses:
            right[k, j] -= slope * u[other]
        for r, line in enumerate(lines):
            stopped = line.slides is None
            for k, c in line.row:
                for j, slope in c.slopes.items() if isinstance(c, Dual) else ():
                    right[k, j] += at(slope, i) * u[n + r]
                    if stopped:
                        right[n + r, j] -= at(slope, i) * u[k]
            if line.slides is None:
                right[n + r] -= (1.0 + line.e.value) * _line(line.rate, i, e.columns)
                for j, slope in line.e.slopes.items():
                    right[n + r, j] -= slope * at(line.rate.value, i)
            else:
                sign, mu, normal = line.slides
                for j, slope in mu.slopes.items():
                    right[n + r, j] -= sign * slope * u[n + normal]
        return right


def check_open(piece: Any, struck: Mapping[str, Struck]) -> None:
    """Refuse runs in which something stays on a surface that it bounces on, and impacts by Poisson's law."""
    if not struck:
        return
    law = impact_law(piece.mechanics.placed.parts)
    if law.law != "newton" or law.several != "together":
        other = "by Poisson's law" if law.law != "newton" else "in turn with others"
        raise SceneError(
            f"sensitivities: {next(iter(struck))!r} bounces {other}; there are derivatives where surfaces with"
            " restitution bounce by Newton's law together"
        )
    rows = piece.rows()
    reactions = piece.mechanics.reactions(rows)
    for name in struck:
        bears = np.flatnonzero(np.abs(np.nan_to_num(reactions[name])).max(axis=0, initial=0.0))
        if bears.size:
            raise SceneError(
                f"sensitivities: {name!r} holds from t = {rows.t[bears[0]]:.6g} on, after its last bounce; there are"
                " derivatives where surfaces with restitution are met and left at once: end the run before"
            )


def _value(c: Any, i: int) -> float:
    return at(c.value, i) if isinstance(c, Dual) else at(c, i)


def _line(dual: Dual, i: int, columns: int) -> Floats:
    """Slopes of a value at time number i (columns,)."""
    found = np.zeros(columns)
    for j, slope in dual.slopes.items():
        found[j] = at(slope, i)
    return found
