"""Pads in holders that move, in the plane and in space, against programs of their own in minimal coordinates."""

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

# -- the plane: a caliper swings on a pin and guides a pad, which a spring presses on a belt -------------------------
H, ARM, J, M, I_PAD = 0.5, 0.1, 0.02, 1.5, 0.004
TURN, PUSH, AT, N0, K = 60.0, 4000.0, 0.4, 30.0, 2e4
MU_S, MU_K, BELT = 0.5, 0.3, 0.1


def caliper():
    """``angle`` turns the guide; the pad's face is ARM below its centre, and touches the belt at y = 0."""
    held = fm.RigidBody("caliper", mass=1.0, inertia=J, position=(0.0, H))
    pad = fm.RigidBody("pad", mass=M, inertia=I_PAD, position=(0.0, H - AT), points={"face": (0.0, -ARM)})
    belt = fm.Driven("belt", velocity={"x": BELT})
    return fm.Scene("caliper", [
        held, pad, belt, fm.Revolute("pin", held, fm.ground_point(0.0, H)),
        fm.Prismatic("guide", pad, held, angle=-math.pi / 2),
        fm.TorsionSpring("turn", held, stiffness=TURN),
        fm.PointSpring("push", pad, held, stiffness=PUSH, length=AT),
        fm.Contact(
            "lining", pad.point("face"), belt, law=fm.laws.Coulomb(mu_s=MU_S, mu_k=MU_K), axes="x",
            normal_force=fm.normal.Spring(axis="y", stiffness=K, preload=N0),
        ),
    ])  # fmt: skip


class Swinging:
    """y = [angle, way s along the guide, their rates]; from transition to transition."""

    def field(self, y):
        """Inverse masses (2,), forces without friction, row of slip, its rate without acceleration, load, slip."""
        phi, s, w, v = y
        c, n, R = math.cos(phi), math.sin(phi), s + ARM
        masses = np.array([J + I_PAD + M * s * s, M])
        N = max(0.0, N0 - K * (H - R * c))
        forces = np.array([-TURN * phi - 2 * M * s * v * w, -PUSH * (s - AT) + M * s * w * w])
        forces += (N - N0) * np.array([R * n, -c])
        row = np.array([R * c, n])
        bend = -R * n * w * w + 2 * c * w * v
        return masses, forces, row, bend, N, row @ [w, v] - BELT

    def held(self, y):
        masses, forces, row, bend, N, _ = self.field(y)
        return -(row @ (forces / masses) + bend) / (row @ (row / masses)), N

    def rates(self, t, y, sense):
        masses, forces, row, _, N, _ = self.field(y)
        F = self.held(y)[0] if sense == 0 else -MU_K * N * sense
        return [*y[2:], *((forces + row * F) / masses)]

    def end(self, y, sense):
        if sense != 0:
            return sense * self.field(y)[5]
        F, N = self.held(y)
        return MU_S * N - abs(F)

    def run(self, t_end):
        t, y, sense, events = 0.0, np.array([0.0, AT, 0.0, 0.0]), -1, []
        while True:
            out = solve_ivp(
                self.rates, (t, t_end), y, args=(sense,), rtol=1e-12, atol=1e-13, dense_output=True, max_step=2e-3,
                method="DOP853",
            )  # fmt: skip
            values = np.array([self.end(at, sense) for at in out.y.T])[2:]
            below = np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0)) + 2
            if not below.size:
                return out.y[:, -1], events
            i = below[0]
            t = brentq(lambda at, f=out.sol, s=sense: self.end(f(at), s), out.t[i], out.t[i + 1], xtol=1e-15)
            y = out.sol(t)
            F, N = self.held(y)
            if sense == 0:
                sense = -1 if F > 0.0 else 1
                events.append(("slip", t))
            elif abs(F) <= MU_S * N:
                sense = 0
                events.append(("stick", t))
            else:
                sense = -sense
                events.append(("reversal", t))


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_a_pad_in_a_caliper_that_swings(rtol):
    y, events = Swinging().run(1.0)
    assert len(events) >= 4
    sol = fm.simulate(caliper(), t_end=1.0, rtol=rtol)
    assert [event.kind for event in sol.events] == [kind for kind, _ in events]
    np.testing.assert_allclose(sol.events.t, [t for _, t in events], atol=10 * rtol)
    assert sol["caliper.angle"][-1] == pytest.approx(y[0], abs=rtol)
    assert math.hypot(sol["pad.x"][-1], sol["pad.y"][-1] - H) == pytest.approx(y[1], abs=rtol)
    assert sol.audit().ok


# -- space: the holder of a pad is a body on springs ------------------------------------------------------------------
MASS, STIFF, LOAD, SPRING, LOSS, RADIUS, SPIN, MU, AXIAL = 0.4, (9e3, 7e3, 2e4), 50.0, 4e4, 60.0, 0.15, 8.0, 0.4, 0.3


def held_pad(friction):
    disc = fm.space.Rotor("disc", mass=3.0, inertia_across=0.2, inertia_axial=AXIAL, spin=SPIN)
    holder = fm.Body("holder", mass=MASS, axes="xyz")
    pad = fm.space.Pad(
        "pad", disc, holder, at=(RADIUS, 0.0, 0.0), normal=(0, 0, 1), preload=LOAD, stiffness=SPRING, damping=LOSS,
        friction=friction,
    )  # fmt: skip
    springs = [
        fm.Spring(f"k{c}", holder, axis=c, stiffness=k, length=-LOAD / k if c == "z" else 0.0)
        for c, k in zip("xyz", STIFF, strict=True)
    ]
    shake = fm.Force("shake", holder, axis="z", value=40.0 * sympy.sin(170.0 * fm.t))
    return fm.Scene("held", [disc, holder, fm.space.Revolute("hub", disc, axis=(0, 0, 1)), pad, *springs, shake])


def own_pad(t_end):
    """y = [holder x y z, spin angle, their rates]."""

    def rates(t, y):
        x, v, w = y[:3], y[4:7], y[7]
        spring = LOAD - SPRING * x[2]
        N = max(0.0, spring * (1.0 - LOSS / LOAD * v[2])) if spring > 0.0 else 0.0
        at = np.array([RADIUS + x[0], x[1]])
        slip = w * np.array([-at[1], at[0]]) - v[:2]
        F = -MU * N * slip / np.linalg.norm(slip)
        a = (-np.array(STIFF) * x + [-F[0], -F[1], N - LOAD + 40.0 * math.sin(170.0 * t)]) / MASS
        return [*v, w, *a, (at[0] * F[1] - at[1] * F[0]) / AXIAL]

    out = solve_ivp(
        rates, (0.0, t_end), [0.0] * 7 + [SPIN], method="DOP853", rtol=1e-12, atol=1e-14, max_step=1e-3
    )
    return out.y[:, -1]


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_pad_whose_holder_moves(method):
    y = own_pad(0.1)
    sol = fm.simulate(held_pad(fm.laws.Coulomb(mu_s=MU)), t_end=0.1, rtol=1e-9, method=method)
    top = max(np.abs(sol[f"holder.{c}"]).max() for c in "xyz")
    for i, c in enumerate("xyz"):
        assert sol[f"holder.{c}"][-1] == pytest.approx(y[i], abs=1e-6 * top if method == "bdf" else 1e-8 * top)
    assert sol.velocity("disc.spin")[-1] == pytest.approx(y[7], rel=1e-7 if method == "bdf" else 1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-8
    assert sol.audit().ok


def test_it_stops_the_disc_and_swings_with_it():
    """Slip ends with the spin; from then on disc and holder move as one on the holder's springs."""
    scene = held_pad(fm.laws.Coulomb(mu_s=MU)).with_parameters({"shake.value": 0.0})
    sol = fm.simulate(scene, t_end=1.2, rtol=1e-9)
    assert sol.events[-1].kind == "stick"
    late = sol.t > sol.events[-1].t
    arm = sol["holder.x"] + RADIUS
    slip = sol.velocity("disc.spin") * arm - sol.velocity("holder.y")
    assert np.abs(slip[late]).max() < 1e-8
    assert sol.audit().ok
