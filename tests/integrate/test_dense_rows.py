"""Many contacts on the modes of one body: steps by series, against a program of its own and against Newton's stages."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.integrate.implicit.scene import dense_rows

CONTACTS, MODES = 14, 24
STIFFNESS, PRELOAD, SPEED = 40.0, 1.0, 0.05
FREQUENCIES, DAMPING = np.linspace(1.0, 9.0, MODES), 0.02
ALONG, ACROSS = np.random.default_rng(7).normal(size=(2, CONTACTS, MODES)) / np.sqrt(MODES)


def pad(*, mu_s: float, mu_k: float, damping: float = 0.0, shaken: float = 0.0) -> fm.Scene:
    """A body of modes on a belt; shapes are drawn at random, so that each contact feels all modes."""
    shapes = {f"p{c}": np.array([ALONG[c], ACROSS[c]]) for c in range(CONTACTS)}
    body = fm.ModalBody("pad", frequencies=FREQUENCIES, damping_ratios=DAMPING, shapes=shapes, axes="xy")
    belt = fm.Driven("belt", velocity={"x": SPEED + shaken * sympy.sin(3 * fm.t)})
    press = fm.normal.Spring(axis="y", stiffness=STIFFNESS, preload=PRELOAD, damping=damping)
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    contacts = [fm.Contact(f"c{c}", body.point(f"p{c}"), belt, law=law, normal_force=press) for c in range(CONTACTS)]
    return fm.Scene("pad", [body, belt, *contacts])


@dataclass
class Pad:
    """The same by formulas of its own: DOP853 from transition to transition."""

    mu_s: float
    mu_k: float
    damping: float = 0.0
    shaken: float = 0.0
    events: list[tuple[float, int, str]] = field(default_factory=list)

    def loads(self, y: np.ndarray) -> np.ndarray:
        """Normal forces before they are cut at 0."""
        return PRELOAD - STIFFNESS * ACROSS @ y[:MODES] - self.damping * ACROSS @ y[MODES:]

    def slip(self, t: float, y: np.ndarray) -> np.ndarray:
        """Velocities over the belt."""
        return ALONG @ y[MODES:] - SPEED - self.shaken * np.sin(3 * t)

    def solve(self, t: float, y: np.ndarray, sense: np.ndarray, closed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations and friction; ``sense`` of slip, 0 where contacts stick."""
        q, v = y[:MODES], y[MODES:]
        N = np.where(closed, self.loads(y), 0.0)
        F = -sense * self.mu_k * N
        free = -(FREQUENCIES**2) * q - 2 * DAMPING * FREQUENCIES * v + ACROSS.T @ (N - PRELOAD) + ALONG.T @ F
        held = closed & (sense == 0)
        W = ALONG[held]
        F[held] = np.linalg.solve(W @ W.T, 3 * self.shaken * np.cos(3 * t) - W @ free)
        return free + W.T @ F[held], F

    def run(self, t_end: float) -> np.ndarray:
        """States at the end; transitions into ``events``."""
        t, y = 0.0, np.zeros(2 * MODES)
        sense, closed = np.sign(self.slip(t, y)), np.ones(CONTACTS, bool)
        while t < t_end:
            watched = [self._watch(c, sense.copy(), closed.copy()) for c in range(2 * CONTACTS)]
            rates = lambda t, y: np.concatenate([y[MODES:], self.solve(t, y, sense, closed)[0]])  # noqa: E731
            found = solve_ivp(rates, (t, t_end), y, method="DOP853", rtol=1e-12, atol=1e-14, events=watched)
            t, y = found.t[-1], found.y[:, -1]
            if found.status == 1:
                self._change(t, y, sense, closed, next(c for c in range(2 * CONTACTS) if len(found.t_events[c])))
        return y

    def _watch(self, c: int, sense: np.ndarray, closed: np.ndarray) -> object:
        """What falls through 0 where contact c (opening and closing: c - CONTACTS) changes."""

        def margin(t: float, y: np.ndarray) -> float:
            if c >= CONTACTS:
                return float(self.loads(y)[c - CONTACTS] * (1 if closed[c - CONTACTS] else -1))
            if not closed[c]:
                return 1.0
            if sense[c] != 0:
                return float(sense[c] * self.slip(t, y)[c])
            return float(self.mu_s * self.loads(y)[c] - abs(self.solve(t, y, sense, closed)[1][c]))

        margin.terminal, margin.direction = True, -1  # type: ignore[attr-defined]
        return margin

    def _change(self, t: float, y: np.ndarray, sense: np.ndarray, closed: np.ndarray, c: int) -> None:
        if c >= CONTACTS:
            c -= CONTACTS
            closed[c] = not closed[c]
            sense[c] = np.sign(self.slip(t, y)[c])
            self.events.append((t, c, "close" if closed[c] else "open"))
            return
        before = sense[c]
        if before != 0:
            sense[c] = 0
        kind = "stick"
        for _ in range(CONTACTS):  # who lets go may let others go
            F = self.solve(t, y, sense, closed)[1]
            over = np.where(closed & (sense == 0), abs(F) - self.mu_s * self.loads(y), -np.inf)
            worst = c if before == 0 and sense[c] == 0 else int(np.argmax(over))
            if (worst != c and over[worst] <= 0) or (worst == c and before != 0 and over[c] <= 0):
                break
            sense[worst] = -np.sign(F[worst])
            if worst == c:
                kind = "slip" if before == 0 else "reversal"
            else:
                self.events.append((t, worst, "slip"))
        self.events.append((t, c, kind))


SCENES = {
    "one coefficient": {"mu_s": 0.5, "mu_k": 0.5}, "two": {"mu_s": 0.6, "mu_k": 0.4},
    "damped": {"mu_s": 0.6, "mu_k": 0.5, "damping": 0.3}, "shaken": {"mu_s": 0.6, "mu_k": 0.5, "shaken": 0.2},
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_many_contacts_against_a_program_of_its_own(name: str, method: str) -> None:
    """Loads that open and close, sticking and slipping of 14 contacts that all feel one another."""
    own = Pad(**SCENES[name])
    end = own.run(6.0)
    sol = fm.simulate(pad(**SCENES[name]), t_end=6.0, rtol=1e-8, method=method)
    found = [(event.t, int(event.contact[1:]), event.kind) for event in sol.events]
    assert len(own.events) > 15
    assert in_order(found) == in_order(own.events)
    np.testing.assert_allclose(sorted(event[0] for event in found), sorted(event[0] for event in own.events), atol=1e-8)
    np.testing.assert_allclose(sol.q[:MODES, -1], end[:MODES], atol=1e-8 * abs(end[:MODES]).max())
    assert method != "radau" or sol.stats.n_lu == 0  # all of it by series


def in_order(events: list[tuple[float, int, str]]) -> list[tuple[int, str]]:
    """Contacts and kinds by time; of what happens at one instant by contact."""
    return [event[1:] for event in sorted(events, key=lambda event: (round(event[0], 7), event[1]))]


@pytest.mark.parametrize("name", SCENES)
def test_series_and_newton_have_the_same_steps(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values at the stages are those of Newton's method, to what that leaves."""
    by_series = fm.simulate(pad(**SCENES[name]), t_end=2.0, rtol=1e-6, method="radau")
    monkeypatch.setattr(dense_rows, "FEW", 10**6)
    by_newton = fm.simulate(pad(**SCENES[name]), t_end=2.0, rtol=1e-6, method="radau")
    assert by_newton.stats.n_lu > 0
    assert [event.kind for event in by_series.events] == [event.kind for event in by_newton.events]
    assert by_series.stats.n_steps == pytest.approx(by_newton.stats.n_steps, rel=0.1)
    for part in ("q", "v"):
        one, other = getattr(by_series, part), getattr(by_newton, part)
        np.testing.assert_allclose(one[:, -1], other[:, -1], atol=1e-7 * abs(other).max())


def test_a_run_behind_one_of_another_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workspaces are lent by sizes: those of a scene without dense rows have no place for any."""
    monkeypatch.setattr(dense_rows, "FEW", 1)
    monkeypatch.setattr(dense_rows, "FULL", 0.0)

    def block(law: fm.laws.FrictionLaw) -> fm.Scene:
        belt = fm.Driven("belt", velocity={"x": 1.0})
        body = fm.ModalBody("b", frequencies=[1.0], damping_ratios=0.0, shapes={"p": np.array([[1.0]])}, axes="x")
        return fm.Scene("s", [body, belt, fm.Contact("c", body.point("p"), belt, law=law, normal_force=1.0)])

    fm.simulate(block(fm.laws.Stribeck(mu_s=0.4, mu_k=0.3, v_s=0.1)), t_end=1.0, method="radau")
    sol = fm.simulate(block(fm.laws.Coulomb(mu_s=0.3, mu_k=0.3)), t_end=1.0, method="radau")
    assert sol.q[0, -1] == pytest.approx(0.3 * (1.0 - np.cos(1.0)), abs=1e-9)


def test_fast_stiff_modes_are_left_to_newton() -> None:
    """Steps that are long beside the fastest period of a mode have no series that is good for anything."""
    shapes = {f"p{c}": np.array([[*ALONG[c], 1e-3]]) for c in range(CONTACTS)}
    frequencies = np.append(FREQUENCIES, 1e7)
    body = fm.ModalBody("pad", frequencies=frequencies, damping_ratios=0.02, shapes=shapes, axes="x")
    belt = fm.Driven("belt", velocity={"x": SPEED})
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.5)
    contacts = [fm.Contact(f"c{c}", body.point(f"p{c}"), belt, law=law, normal_force=1.0) for c in range(CONTACTS)]
    sol = fm.simulate(fm.Scene("pad", [body, belt, *contacts]), t_end=1.0, rtol=1e-6, method="radau")
    slow = fm.simulate(fm.Scene("pad", [body, belt, *contacts]), t_end=1.0, rtol=1e-9, method="radau")
    assert sol.stats.n_lu > 0
    np.testing.assert_allclose(sol.q[:MODES, -1], slow.q[:MODES, -1], atol=1e-6)


@pytest.mark.parametrize("name", SCENES)
def test_energy_and_laws_hold_between_the_steps(name: str) -> None:
    """The audit knows formulas alone: work of dampers in contacts and of the belt, cones, loads."""
    sol = fm.simulate(pad(**SCENES[name]), t_end=6.0, rtol=1e-8, method="radau")
    found = sol.audit()
    assert found.ok, found


def test_of_many_at_rest_those_let_go_that_have_to() -> None:
    """A combination exists, whatever the limits; a search by releasing and holding alone went round in circles."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        scene, limits = resting_blocks(rng)
        sol = fm.simulate(scene, t_end=1e-3, rtol=1e-6, method="radau")
        force = np.array([sol.force(f"c{c}")[0, -1] for c in range(CONTACTS)])
        slip = np.array([sol.relative_velocity(f"c{c}")[0, -1] for c in range(CONTACTS)])
        for F, g, (most, least) in zip(force, slip, limits, strict=True):
            assert abs(F) <= most * (1 + 1e-9) if g == 0 else pytest.approx(-np.sign(g) * least) == F


def resting_blocks(rng: np.random.Generator) -> tuple[fm.Scene, list[tuple[float, float]]]:
    """A body at rest on modes that differ by little, pushed at once beyond what its contacts hold."""
    shapes = {f"p{c}": (np.ones(MODES) + 0.3 * rng.normal(size=MODES))[None] for c in range(CONTACTS)}
    push = {"push": rng.normal(size=MODES)[None]}
    body = fm.ModalBody("b", frequencies=FREQUENCIES, damping_ratios=DAMPING, shapes=shapes | push, axes="x")
    limits = [(most, most * rng.uniform(0.3, 0.9)) for most in rng.uniform(0.02, 0.2, CONTACTS)]
    contacts = [
        fm.Contact(f"c{c}", body.point(f"p{c}"), law=fm.laws.Coulomb(mu_s=most, mu_k=least), normal_force=1.0)
        for c, (most, least) in enumerate(limits)
    ]
    load = fm.Force("load", body.point("push"), axis="x", value=1.0)
    return fm.Scene("resting", [body, load, *contacts]), limits


@dataclass(frozen=True, kw_only=True)
class Bumpy(fm.normal.NormalLaw):
    """A spring with a bump that no coarse set of distances shows."""

    stiffness: object

    def define_normal(self, e, e_dot):
        """Linear but for the bump."""
        return self.preload - self.stiffness * e + 0.5 * sympy.exp(-(((e - 0.013) / 0.002) ** 2))

    def define_stored(self, e):
        """Its integral."""
        bump = 0.5 * 0.002 * sympy.sqrt(sympy.pi) / 2 * sympy.erf((e - 0.013) / 0.002)
        return self.preload * e - self.stiffness * e**2 / 2 + bump


@dataclass(frozen=True, kw_only=True)
class Jumping(fm.normal.NormalLaw):
    """A spring that presses more from some approach on: its slope is the same on both sides."""

    stiffness: object

    def define_normal(self, e, e_dot):
        """Linear but for the jump."""
        return self.preload - self.stiffness * e + sympy.Piecewise((0.3, e < -0.005), (0.0, True))

    def define_stored(self, e):
        """Its integral."""
        more = sympy.Piecewise((0.3 * (e + 0.005), e < -0.005), (0.0, True))
        return self.preload * e - self.stiffness * e**2 / 2 + more


@dataclass(frozen=True, kw_only=True)
class Offset(fm.normal.NormalLaw):
    """A spring with more at no distance than its preload, which no potential of its own knows."""

    stiffness: object

    def define_normal(self, e, e_dot):
        """Linear."""
        return self.preload + 0.5 - self.stiffness * e


@pytest.mark.parametrize("law", [Bumpy, Jumping, Offset])
def test_a_law_that_is_no_plain_spring_has_no_series(law: type[fm.normal.NormalLaw]) -> None:
    """What is linear is known from its formula, not from values or slopes; and energies hold."""
    scene = replaced(pad(mu_s=0.6, mu_k=0.4), law(axis="y", stiffness=STIFFNESS, preload=PRELOAD))
    sol = fm.simulate(scene, t_end=0.2, rtol=1e-6, method="radau")
    assert sol.stats.n_lu > 0
    assert sol.audit().ok


def test_short_steps_and_rest_have_series_too() -> None:
    """Terms of short steps are nothing before there are as many as the inputs have."""
    stairs = [(SPEED * (1 + 0.1 * i), fm.t < 0.025 * (i + 1)) for i in range(20)]
    for belt in (0.0, sympy.Piecewise(*stairs, (0.0, True))):
        scene = pad(mu_s=0.6, mu_k=0.4)
        driven = fm.Driven("belt", velocity={"x": belt})
        parts = [
            driven if part.name == "belt" else replace(part, b=driven) if isinstance(part, fm.Contact) else part
            for part in scene.parts
        ]
        sol = fm.simulate(fm.Scene("pad", parts), t_end=0.5, rtol=1e-6, method="radau")
        assert sol.stats.n_lu == 0


def replaced(scene: fm.Scene, press: fm.normal.NormalLaw) -> fm.Scene:
    """The scene with another law of normal forces."""
    parts = [replace(part, normal_force=press) if isinstance(part, fm.Contact) else part for part in scene.parts]
    return fm.Scene("pad", parts)
