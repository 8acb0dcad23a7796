"""What is kept at wanted times."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor._account import coupled_pay
from fricmb.integrate.taylor._change import hold_force
from fricmb.integrate.taylor._layout import DAMPING, INPUT, N_SAMPLES, STEP
from fricmb.integrate.taylor._ledger import belt_work, count_rest
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._series import belt_value, displacement, force_row, horner, horner_rate


@kernel
def sample(net: Net, s: float) -> None:
    """State, forces and energies at s."""
    at = net.i[N_SAMPLES]
    h = net.x[STEP]
    last = net.Q.shape[0] - 1
    q = net.out_q[at]
    v = net.out_v[at]
    horner(net.Q, last, s, q)
    horner_rate(net.Q, last, s, h, v)
    coupled = net.coupled.F.shape[0] > 0
    if coupled:
        coupled_pay(net, s, net.places)
    for c in range(net.mode.shape[0]):
        stuck = net.mode[c] != SLIP
        net.out_mode[at, c] = net.mode[c]
        loss = net.loss[c]
        if stuck:
            value = 0.0
            for k in range(net.R.shape[0] - 1, -1, -1):
                value = value * s + force_row(net, c, k, h)
            net.out_F[at, c] = value
            net.out_g[at, c] = 0.0
        else:
            g = -belt_value(net, c, s)
            for e in range(net.row_start[c], net.row_start[c + 1]):
                g += net.row_coef[e] * v[net.row_dof[e]]
            net.out_F[at, c] = hold_force(net, c, s, h) if coupled else -net.slip[c] * net.sigma[c]
            net.out_g[at, c] = g
            loss += 0.0 if coupled else net.slip[c] * abs(displacement(net, c, s, h) - net.mark[c])
        net.out_loss[at, c] = loss
    brought, lost = net.x[INPUT], net.x[DAMPING]
    count_rest(net, s, -1.0)
    net.out_x[at, 0] = net.x[INPUT] - belt_work(net, s)
    net.out_x[at, 1] = net.x[DAMPING]
    net.x[INPUT], net.x[DAMPING] = brought, lost
    net.i[N_SAMPLES] = at + 1
