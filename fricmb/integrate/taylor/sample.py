"""What is kept at wanted times."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.account import displacement, pay_groups
from fricmb.integrate.taylor.friction_curve import friction_at
from fricmb.integrate.taylor.landing_path import follow_landing
from fricmb.integrate.taylor.layout import AT, UNIT, WORK
from fricmb.integrate.taylor.ledger import belt_work, count_rest
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.plane_series import lands
from fricmb.integrate.taylor.polynomials import hold_force, horner, horner_rate, shift_slip, slip_speed
from fricmb.integrate.taylor.rubbing import is_lost, rubbing_at


@kernel
def sample(net: Net, s: float) -> None:
    """State, forces and energies at s."""
    at = net.n_samples
    last = net.Q.shape[0] - 1
    q, v, response = net.out_q[at], net.out_v[at], net.flat[WORK]
    horner(net.Q, last, s, q)
    horner_rate(net.Q, last, s, net.step, v)
    horner(net.R, last - 2, s, response)
    pay_groups(net, s)
    for c in range(net.mode.shape[0]):
        plain, slips = net.plain[c] == 1, net.mode[c] == SLIP
        e, j = net.row_start[c], net.first_dof[c]
        net.out_mode[at, c] = net.mode[c]
        net.out_g[at, c] = slip_speed(net, c, v, s) if slips else 0.0
        net.out_loss[at, c] = net.loss[c]
        if not plain:
            net.out_F[at, c] = hold_force(net, c, s)
        elif slips:
            net.out_F[at, c] = -net.slip[c] * net.sigma[c]
            net.out_loss[at, c] += net.slip[c] * abs(displacement(net, c, q[j], s) - net.mark[c])
        else:
            net.out_F[at, c] = -net.row_coef[e] * response[j] / net.compliance[c]
    for c in range(net.mode.shape[0] if has_planes(net) else 0):
        if lands(net, c):
            sample_landing(net, c, s, at)
        elif is_lost(net, c):
            sample_lost(net, c, at)
    brought, lost = net.supply, net.damping
    count_rest(net, s, -1.0)
    net.out_x[at, 0] = net.supply - belt_work(net, s)
    net.out_x[at, 1] = net.damping
    net.supply, net.damping = brought, lost
    net.n_samples = at + 1


@kernel
def sample_landing(net: Net, c: int, s: float, at: int) -> None:
    """Velocity and friction of contact c, which comes to rest: its polynomials lead there, but by another way."""
    plan = net.groups.landing[net.groups.planar[c]]
    follow_landing(plan, s * net.step)
    rubs = friction_at(net, c, math.hypot(plan[AT], plan[AT + 1]))
    for i in range(2):
        shift_slip(net, c + i, plan[AT + i] - net.out_g[at, c + i], net.out_v[at])
        net.out_g[at, c + i], net.out_F[at, c + i] = plan[AT + i], -rubs * plan[UNIT + i]


@kernel
def sample_lost(net: Net, c: int, at: int) -> None:
    """Friction of contact c, of which powers of s do not tell, at sample ``at``."""
    x, y = net.out_g[at, c], net.out_g[at, c + 1]
    rubs = rubbing_at(net, c, x, y)
    if rubs >= 0.0:
        net.out_F[at, c], net.out_F[at, c + 1] = -rubs * x, -rubs * y

