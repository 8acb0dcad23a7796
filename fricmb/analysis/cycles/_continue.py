"""Continuation of a cycle over a parameter by pseudo-arclength, through folds and the borders of friction."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fricmb._calls import answers
from fricmb._simulate._progress import bar
from fricmb.analysis._errors import AnalysisError, Floats, checked_integer, checked_kind, positive
from fricmb.analysis.cycles._border import beyond, on_border, solve_border
from fricmb.analysis.cycles._branch import Branch
from fricmb.analysis.cycles._cycle import Cycle, as_cycle
from fricmb.analysis.cycles._locate import changes
from fricmb.analysis.cycles._predict import Point, check_parameter, correct, direction, recut
from fricmb.analysis.cycles._sequence import borders, sequence
from fricmb.analysis.cycles._shooting import Orbit, solve
from fricmb.analysis.cycles._specials import Fold, Grazing, Special, StickAppears, StickDisappears

_WHO = "continue_cycle"
#: Most cycles of a branch.
_MOST_POINTS = 1_000_000
#: First and largest step, in units of the cycle's extent and of the range of the parameter; least before giving up.
_FIRST, _LARGEST, _LEAST = 0.02, 0.2, 1e-6
#: Largest turn of the branch's direction in one step (radians).
_TURN = 0.35
#: Cycles whose extent is below this part of the first one's have shrunk to rest.
_REST = 1e-3


@answers
def continue_cycle(
    cycle: Cycle, over: str, *, to: float, points: int = 200, largest_step: float = _LARGEST, progress: bool = True
) -> Branch:
    """Follow a cycle over a parameter, stable or not.

    Parameters
    ----------
    cycle : Cycle
    over : str
        Out of ``scene.parameters``.
    to : float
        Value of the parameter at which the branch ends; a branch that turns round ends where it comes back to its
        first value.
    points : int
        Largest number of cycles.
    largest_step : float
        Of the arclength, in units of the cycle's extent and of the range of the parameter.
    progress : bool
        Show a bar on the terminal.

    Returns
    -------
    Branch

    Raises
    ------
    AnalysisError
        For a parameter that is no number, or values that are not accepted.
    UnknownNameError
        For a parameter that the scene does not have.

    Notes
    -----
    Pseudo-arclength continuation (H. B. Keller, 1977) on the equations of :func:`limit_cycle`.  Where the sequence of
    transitions changes, the orbit on the border (a stick of length 0, a slip speed that touches 0) is solved as a
    problem of its own, with the phases given and their lengths unknown: that is smooth where the branch is not (R. I.
    Leine and H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004).  Between borders folds,
    flips and Neimark-Sacker points are roots of the parameter's slope, of det(DP + I) and of the product of
    1 - l_i l_j.
    """
    checked_kind(_WHO, "cycle", cycle, Cycle, "a Cycle, as limit_cycle returns it")
    points = checked_integer(_WHO, "points", points, 1, _MOST_POINTS)
    largest_step = positive(_WHO, "largest_step", largest_step)
    value = check_parameter(cycle.orbit, over, to, _WHO)
    first = recut(_with_parameter(cycle.orbit, over), over)
    scale = abs(to - value)
    ahead = direction(first, over, scale)
    if ahead[-1] * (to - value) < 0.0 or ahead[-1] == 0.0:
        ahead = -ahead
    point = Point(orbit=first, over=over, p_scale=scale, forward=ahead)
    return follow(point, float(to), points, largest_step, progress)


def follow(point: Point, to: float, points: int, largest: float, progress: bool) -> Branch:
    """A branch from one of its points in the direction given there."""
    walk = Walk(point=point, to=to, begin=point.value, largest=largest)
    with bar(points, "cycle", "branch", progress) as shown:
        while not walk.ended and len(walk.cycles) < points:
            before = len(walk.cycles)
            walk.step()
            shown.update(len(walk.cycles) - before)
    return Branch(
        over=point.over, to=to, cycles=tuple(walk.cycles), special=tuple(walk.special), places=tuple(walk.places),
        ended=walk.ended or f"after {points} cycles, the limit given by points=",
    )  # fmt: skip


@dataclass(kw_only=True)
class Walk:
    """A branch while it is followed."""

    point: Point
    to: float
    begin: float
    largest: float
    h: float = _FIRST
    ended: str = ""
    cycles: list[Cycle] = field(default_factory=list)
    special: list[Special] = field(default_factory=list)
    places: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._goal = max(1e-12, 0.1 * float(self.point.orbit.shooting.flow.options.get("rtol", 1e-10)))
        self._extent = float(np.linalg.norm(_extent(self.point.orbit)))
        self.cycles.append(as_cycle(self.point.orbit))

    def step(self) -> None:
        """One more cycle, a border, or a shorter step."""
        point, h = self.point, self.h
        found = correct(point.orbit, point.over, point.p_scale, h * point.forward, point.forward, self._goal)
        ahead = None if found is None else _direction_on(found, point)
        same = found is not None and sequence(found) == sequence(point.orbit)
        if not same:
            if self._border():
                return
            if found is None or self.h > 1e-3:
                self._shorten()
                return
        assert found is not None
        assert ahead is not None
        if same and h > 1e-3 and float(ahead @ point.forward) < np.cos(_TURN):
            self._shorten()
            return
        if not same:
            self._note_exchange(found)
            if self.ended:
                return
        self._accept(found, ahead)
        self.h = min(1.6 * h, self.largest)

    def _shorten(self) -> None:
        self.h *= 0.5
        if self.h < _LEAST:
            self.ended = f"no cycle found beyond {self.point.over} = {self.point.value:.8g}"

    def _accept(self, found: Orbit, ahead: Floats) -> None:
        """A cycle of the same kind; what happens between it and the last one is located."""
        point = self.point
        following = Point(orbit=found, over=point.over, p_scale=point.p_scale, forward=ahead)
        low, high = sorted((self.begin, self.to))
        for special in changes(point, following, self._goal):
            if isinstance(special, Fold) and self._is_rest(special.cycle.orbit):
                self.cycles.append(special.cycle)
                self.ended = f"the cycle shrinks to rest at {point.over} = {special.value:.8g}"
                return
            if low <= special.value <= high:
                self._add(special)
        self._go_to(following)

    def _go_to(self, following: Point) -> None:
        if self._has_left(following):
            return
        cut = recut(following.orbit, following.over)
        ahead = following.forward if cut.y is following.orbit.y else _oriented(cut, following)
        self.point = Point(orbit=cut, over=following.over, p_scale=following.p_scale, forward=ahead)
        self.cycles.append(as_cycle(cut))
        if self._is_rest(cut):
            self.ended = f"the cycle shrinks to rest at {following.over} = {following.value:.8g}"

    def _is_rest(self, orbit: Orbit) -> bool:
        """Whether a cycle has shrunk to an equilibrium, through which the equations would go on to the same cycles."""
        return float(np.linalg.norm(_extent(orbit))) < _REST * self._extent

    def _has_left(self, following: Point) -> bool:
        """End the branch where the parameter passes its end, or comes back to where it began."""
        low, high = sorted((self.begin, self.to))
        value, old = following.value, self.point.value
        if low <= value <= high:
            return False
        if following.slope * self.point.slope < 0 and not low <= old <= high:
            return False
        edge = high if value > high else low
        at = following.orbit.shooting.with_values({following.over: edge})
        try:
            last = solve(at.orbit(following.orbit.y, at.period(following.orbit.T)), self._goal, _WHO)
            self.cycles.append(as_cycle(_with_parameter(last, following.over)))
        except AnalysisError:
            self.cycles.append(as_cycle(following.orbit))
        self.ended = f"ended at {following.over} = {edge:.8g}" + (" where it began" if edge == self.begin else "")
        return True

    def _border(self) -> bool:
        """Solve a border near by and go on behind it; False where there is none."""
        point = self.point
        for border in borders(point.orbit):
            solved = solve_border(point.orbit, border, point.over, point.p_scale)
            if solved is None or not self._is_ahead(solved.value):
                continue
            orbit = on_border(solved, point.orbit.shooting)
            other = beyond(solved, point.orbit.shooting)
            kind: type[Special] = StickAppears
            if border.kind == "stick":
                kind = StickDisappears
            elif other is None:
                kind = Grazing
            cycle, residual = as_cycle(orbit), solved.found.residual
            self._add(kind(value=solved.value, cycle=cycle, residual=residual))
            if other is None:
                self.cycles.append(cycle)
                self.ended = f"ends at {point.over} = {solved.value:.8g}, where a slip speed touches 0"
                return True
            lap, (dT, dp) = other
            if dp * point.slope < 0.0:
                self._add(Fold(value=solved.value, cycle=cycle, residual=residual))
            self._leave(lap, float(dT), float(dp))
            return True
        return False

    def _leave(self, lap: Orbit, dT: float, dp: float) -> None:
        """Go on from a first cycle behind a border."""
        point = self.point
        ahead = direction(lap, point.over, point.p_scale)
        free = lap.shooting.drive is None
        likeness = ahead[-1] * dp + (ahead[-2] * dT if free else 0.0)
        following = Point(
            orbit=lap, over=point.over, p_scale=point.p_scale, forward=ahead if likeness > 0.0 else -ahead
        )
        self.h = _FIRST
        self._go_to(following)

    def _is_ahead(self, value: float) -> bool:
        """Whether a border lies where the branch goes, not far beyond the step that was tried."""
        point = self.point
        along = (value - point.value) / point.p_scale
        return bool(-2.0 * self.h <= along * float(np.sign(point.slope or 1.0)) <= 4.0 * self.h + 1e-6)

    def _note_exchange(self, found: Orbit) -> None:
        """Transitions of different contacts may change places; any other change has to be a border."""
        if _by_contact(found) != _by_contact(self.point.orbit):
            self.ended = (
                f"the sequence of transitions changes beyond {self.point.over} = {self.point.value:.8g}, and the border"
                " was not found"
            )

    def _add(self, special: Special) -> None:
        self.special.append(special)
        self.places.append(len(self.cycles))


def _by_contact(orbit: Orbit) -> dict[str, tuple[str, ...]]:
    kinds: dict[str, list[str]] = {}
    for event in orbit.arc.solution.events:
        kinds.setdefault(event.contact, []).append(event.kind)
    return {name: min(tuple(k[i:] + k[:i]) for i in range(len(k))) for name, k in kinds.items()}


def _extent(orbit: Orbit) -> Floats:
    samples = orbit.arc.solution.at(np.linspace(orbit.arc.solution.t_start, orbit.arc.solution.t_end, 201)).q
    return np.asarray(np.ptp(samples, axis=1))


def _with_parameter(orbit: Orbit, over: str) -> Orbit:
    """The same lap with its derivative by the parameter."""
    return orbit if over in orbit.arc.by else orbit.shooting.orbit(orbit.y, orbit.T, (over,))


def _direction_on(found: Orbit, point: Point) -> Floats:
    """The branch's direction at a cycle, the way it came."""
    ahead = direction(found, point.over, point.p_scale)
    if ahead.size != point.forward.size:
        return _oriented(found, point)
    return ahead if float(ahead @ point.forward) >= 0.0 else -ahead


def _oriented(cut: Orbit, point: Point) -> Floats:
    """Direction at the same cycle from another section: told by period and parameter."""
    ahead = direction(cut, point.over, point.p_scale)
    tail = 1 if cut.shooting.drive is not None else 2
    return ahead if float(ahead[-tail:] @ point.forward[-tail:]) >= 0.0 else -ahead
