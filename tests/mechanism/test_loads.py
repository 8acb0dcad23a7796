"""Loads of joints that pass through 0, and joints that hold more than there is to hold."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import fricmb as fm

CRANK, ROD, MASSES, ANGLE, SPEED, PIN, MU = 0.1, 0.3, (1.0, 0.6, 0.8), 0.3, 30.0, 0.01, 0.2


class SliderCrank:
    """Newton's and Euler's equations of crank, rod and slider in the crank's angle, signs of slip and load given.

    Unknown are the crank's acceleration and the forces in bearing (2), big end (2), small end (2) and guide; friction
    depends on them by their magnitudes, and is found by iteration.
    """

    def __init__(self):
        self.signs = np.ones(5)

    def moves(self, angle, rate):
        """Angle and rate of the rod, rates of slip in the joints."""
        lean = np.arcsin(CRANK * np.sin(angle) / ROD)
        turn = -rate * CRANK * np.cos(angle) / (ROD * np.cos(lean))
        slide = -CRANK * np.sin(angle) * rate - ROD * np.sin(-lean) * turn
        return -lean, turn, np.array([rate, turn - rate, -turn, slide])

    def solve(self, angle, rate):
        """The acceleration, and the guide's force."""
        phi, turn, _ = self.moves(angle, rate)
        e, d = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        f, g = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        # phi'' = p a + s from the height of the slider, 0 = CRANK sin(angle) + ROD sin(phi)
        p = -CRANK * np.cos(angle) / (ROD * np.cos(phi))
        s = (CRANK * np.sin(angle) * rate**2 + ROD * np.sin(phi) * turn**2) / (ROD * np.cos(phi))
        one = (CRANK / 2 * d, -CRANK / 2 * e * rate**2)
        two = (CRANK * d + ROD / 2 * p * g, -CRANK * e * rate**2 + ROD / 2 * (s * g - turn**2 * f))
        three = (CRANK * d + ROD * p * g, -CRANK * e * rate**2 + ROD * (s * g - turn**2 * f))
        m1, m2, m3 = MASSES
        A, b = np.zeros((8, 8)), np.zeros(8)

        def cross(r):
            return np.array([-r[1], r[0]])

        for i in range(2):
            A[i, 0], A[i, 1 + i], A[i, 3 + i], b[i] = m1 * one[0][i], -1, 1, -m1 * one[1][i]
            A[3 + i, 0], A[3 + i, 3 + i], A[3 + i, 5 + i], b[3 + i] = m2 * two[0][i], -1, 1, -m2 * two[1][i]
            A[6 + i, 0], A[6 + i, 5 + i], b[6 + i] = m3 * three[0][i], -1, -m3 * three[1][i]
        A[2, 0], A[2, 1:3], A[2, 3:5] = m1 * CRANK**2 / 12, -cross(-CRANK / 2 * e), cross(CRANK / 2 * e)
        A[5, 0], A[5, 3:5], A[5, 5:7] = m2 * ROD**2 / 12 * p, -cross(-ROD / 2 * f), cross(ROD / 2 * f)
        b[5] = -m2 * ROD**2 / 12 * s
        A[7, 7] = -1
        inverse, x = np.linalg.inv(A), np.zeros(8)
        for _ in range(100):
            load = [np.hypot(*x[1:3]), np.hypot(*x[3:5]), np.hypot(*x[5:7]), self.signs[4] * x[7]]
            F = -MU * self.signs[:4] * load
            r = b.copy()
            r[2] += PIN * (F[0] - F[1])
            r[5] += PIN * (F[1] - F[2])
            r[6] += F[3]
            new = inverse @ r
            if np.abs(new - x).max() <= 1e-15 * np.abs(new).max():
                break
            x = new
        return new[0], new[7]

    def events(self):
        """Slip of three joints and the guide's force, each where it leaves its present sign."""
        functions = [lambda t, y, i=i: self.moves(*y)[2][i] for i in range(1, 4)]
        functions.append(lambda t, y: self.solve(*y)[1])
        for function, sign in zip(functions, self.signs[1:], strict=True):
            function.terminal, function.direction = True, -sign
        return functions

    def run(self, until):
        """The angle at the end; every piece has its signs."""
        t, y = 0.0, np.array([ANGLE, SPEED])
        self.signs[:4] = np.sign(self.moves(*y)[2])
        self.signs[4] = np.sign(self.solve(*y)[1])
        while t < until:
            piece = solve_ivp(
                lambda t, y: [y[1], self.solve(*y)[0]], (t, until), y, method="DOP853", rtol=1e-13, atol=1e-14,
                events=self.events(),
            )  # fmt: skip
            t, y = piece.t[-1], piece.y[:, -1]
            which = [1 + i for i, times in enumerate(piece.t_events) if len(times)]
            self.signs[which] *= -1
            # a reversal makes forces jump
            if which and which != [4] and self.signs[4] * self.solve(*y)[1] < 0:
                self.signs[4] *= -1
        return y[0]


@pytest.mark.slow
def test_slider_crank_with_dry_joints_against_its_reduced_equation():
    """The guide's force passes through 0: its magnitude has a kink, and steps end there."""
    exact = SliderCrank().run(1.0)
    scene = fm.models.slider_crank(friction=fm.laws.Coulomb(mu_s=MU))
    for method, rtol, error in (("radau", 1e-6, 2e-7), ("radau", 1e-8, 1e-9), ("radau", 1e-10, 2e-11),
                                ("bdf", 1e-8, 5e-9)):  # fmt: skip
        sol = fm.simulate(scene, t_end=1.0, rtol=rtol, method=method)
        assert sol["crank.angle"][-1] == pytest.approx(exact, rel=0, abs=error)
    # not a transition
    assert {event.kind for event in sol.events} == {"reversal"}


BARS = ("crank", "coupler", "rocker")
#: Pins by their bodies: the first has the reaction and the friction as they are, the second both reversed.
ENDS = {"A": (("crank", "root"), None), "B": (("coupler", "root"), ("crank", "tip")),
        "C": (("rocker", "tip"), ("coupler", "tip")), "D": (("rocker", "root"), None)}  # fmt: skip
LENGTHS = {"crank": 0.1, "coupler": 0.3, "rocker": 0.25}


def loads_on_bars(angles, reaction, moment, motor):
    """Forces and moments about their centres (9,) on the bars of ``four_bar`` under weight, to be 0 at rest."""
    total = {name: np.array([0.0, -9.81 * 5.0 * LENGTHS[name], 0.0]) for name in BARS}
    total["crank"][2] += motor
    for pin, ends in ENDS.items():
        for end, sign in zip(ends, (1.0, -1.0), strict=True):
            if end is None:
                continue
            body, point = end
            arm = LENGTHS[body] / 2 * (1.0 if point == "tip" else -1.0)
            x, y = arm * np.cos(angles[body]), arm * np.sin(angles[body])
            fx, fy = sign * reaction[pin]
            total[body] += [fx, fy, x * fy - y * fx + sign * moment[pin]]
    return np.concatenate([total[name] for name in BARS])


@pytest.mark.parametrize(("mu", "rtol", "method"), [(0.6, 1e-6, "radau"), (0.3, 1e-8, "radau"), (0.9, 1e-7, "bdf")])
def test_four_dry_pins_come_to_rest_together(mu, rtol, method):
    """One motion is left and four pins hold it: what each holds is not determined, that they hold is."""
    sol = fm.simulate(fm.models.four_bar(friction=fm.laws.Coulomb(mu_s=mu)), t_end=12.0, rtol=rtol, method=method)
    rest = sol.events.t[-1]
    assert rest < 6.0
    assert {event.kind for event in sol.events if event.t == rest} <= {"stick"}
    assert np.abs(sol.v[:, sol.t > rest]).max() < 1e-12
    angles = {name: sol[f"{name}.angle"][-1] for name in BARS}
    moment = {pin: 0.005 * sol.force(pin)[0, -1] for pin in ENDS}
    out_of_balance = loads_on_bars(angles, {pin: sol.reaction(pin)[:, -1] for pin in ENDS}, moment, 0.0)
    assert np.abs(out_of_balance).max() < 1e-10
    for pin in ENDS:
        assert np.abs(sol.force(pin)[0, -1]) <= mu * sol.normal_force(pin)[-1] * (1 + 1e-9)
    (note,) = [note for note in sol.stats.notes if "not determined" in note]
    assert "'A'" in note


def break_away(angles, mu):
    """Torque on the crank, forwards, at which all four pins of a linkage at rest slip."""
    a, b, c = (angles[name] for name in BARS)
    l1, l2, l3 = LENGTHS.values()
    # closure: l1 e(a) + l2 e(b) - l3 e(c) is constant; the crank turns at 1
    A = np.array([[-l2 * np.sin(b), l3 * np.sin(c)], [l2 * np.cos(b), -l3 * np.cos(c)]])
    coupler, rocker = np.linalg.solve(A, [l1 * np.sin(a), -l1 * np.cos(a)])
    slip = {"A": 1.0, "B": coupler - 1.0, "C": rocker - coupler, "D": rocker}

    def balance(x):
        reaction = dict(zip(ENDS, x[:8].reshape(4, 2), strict=True))
        moment = {pin: -0.005 * mu * np.hypot(*reaction[pin]) * np.sign(slip[pin]) for pin in ENDS}
        return loads_on_bars(angles, reaction, moment, x[8])

    return fsolve(balance, np.append(np.tile([1.0, 10.0], 4), 0.1), xtol=1e-12)[8]


@pytest.mark.parametrize(("rtol", "method"), [(1e-6, "radau"), (1e-9, "radau"), (1e-6, "bdf")])
def test_a_linkage_held_by_its_pins_breaks_away_where_statics_says(rtol, method):
    """One pin after the other reaches its limit; it moves when the last does, however the load was shared before."""
    scene = fm.models.four_bar(friction=fm.laws.Coulomb(mu_s=0.6), torque=0.5 * fm.t, angle=-1.87)
    sol = fm.simulate(scene, t_end=0.3, rtol=rtol, method=method)
    exact = break_away({name: sol[f"{name}.angle"][0] for name in BARS}, 0.6) / 0.5
    assert np.isclose(sol.events.t, exact, rtol=0, atol=1e-10).any()
    assert sol.at([exact + 1e-3]).velocity("crank.angle")[0] > 1e-5
    assert np.abs(sol.at([exact - 1e-6]).velocity("crank.angle")).max() < 1e-14
