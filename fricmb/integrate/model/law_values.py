"""Laws inside kernels: slip coefficient and smooth force of a contact."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Ports, Table
from fricmb.integrate.problem import LAW_COEFFICIENT, Floats


@kernel
def coefficient(ports: Ports, laws: Table, k: int, s: Scratch, r: float, N: float) -> tuple[float, float, float]:
    """mu, dmu/dr, dmu/dN at slip speed r; constant for r < 0, where iterates may pass.

    (Continued along its slope a falling law would have a second solution there at large steps.)
    """
    if ports.law[k] != LAW_COEFFICIENT:
        return ports.mu_0[k], 0.0, 0.0
    s.x[0] = max(r, 0.0)
    s.x[1] = N
    call(laws.address[k], s.x, 0, laws.p, laws.p_start[k], s.out, 0)
    return s.out[0], 0.0 if r < 0.0 else s.out[1], s.out[2]


@kernel
def break_away(ports: Ports, laws: Table, k: int, s: Scratch, N: float) -> float:
    """Coefficient up to which a contact sticks: declared, or (``mu_s`` < 0) the limit of the coefficient under N."""
    if ports.mu_s[k] >= 0.0:
        return float(ports.mu_s[k])
    return float(coefficient(ports, laws, k, s, 0.0, N)[0])


@kernel
def smooth_force(
    laws: Table, k: int, s: Scratch, g: Floats, g0: int, d: int, N: float, z: Floats, z0: int, nz: int
) -> None:
    """Force, state rates and Jacobian of a smooth law into s.out (layout: see Contacts.law)."""
    for a in range(d):
        s.x[a] = g[g0 + a]
    s.x[d] = N
    for a in range(nz):
        s.x[d + 1 + a] = z[z0 + a]
    call(laws.address[k], s.x, 0, laws.p, laws.p_start[k], s.out, 0)
