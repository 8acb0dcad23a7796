"""Forces and reactions at given states, and the constraints as a matrix: what is asked for outside of a run."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.forces import call_joint, contact_slip, forces, move
from fricmb.integrate.implicit.equations.jacobian_layers import place_slope
from fricmb.integrate.implicit.equations.projection import project_positions, project_velocities
from fricmb.integrate.implicit.equations.slip_rows import plane
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.forces import stored_by_damped
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import SLIP, STICK, Codes2, Floats, Floats2, Ints
from fricmb.integrate.run.breakpoints import set_window_around


@entry
def instants(
    mech: Mech, k: Moving, w: Instant, y: State, times: Floats, q: Floats2, v: Floats2, z: Floats2, mode: Codes2,
    force: Floats2, small: Floats, F: Floats2, N: Floats2, g: Floats2, lam: Floats2, a: Floats2,
    stored: Floats, project: bool, side: Floats, power: Floats2,
) -> int:  # fmt: skip
    """Complete every state (row by row); ``force`` (n_t, m + 2 m_p) start values [lam, F, n].  Number of failures.

    ``small`` (n_t,): slip slower than that keeps its direction n;
    ``project``: q and v, interpolated between steps, are first moved onto the constraints; ``stored`` (n_t,): energy in
    contacts with damping; ``side`` (n_t,): a time on the side of a breakpoint on which each state is; ``power``
    (n_t, n_c + 2): what friction, damping and input take and give.
    """
    m, rows, n_c = y.lam.shape[0], y.F.shape[0], y.mode.shape[0]
    failed = 0
    for i in range(times.shape[0]):
        y.t = times[i]
        set_window_around(mech.breakpoints, k.s.window, side[i])
        for j in range(y.q.shape[0]):
            y.q[j] = q[i, j]
            y.v[j] = v[i, j]
        for j in range(y.z.shape[0]):
            y.z[j] = z[i, j]
        for j in range(m):
            y.lam[j] = force[i, j]
        for j in range(rows):
            y.F[j] = force[i, m + j]
            y.n[j] = force[i, m + rows + j]
        for j in range(n_c):
            y.mode[j] = mode[i, j]
        if project and m > 0 and project_positions(mech, k, w, y):
            project_velocities(mech, k, w, y, True, False)
            for j in range(y.q.shape[0]):
                q[i, j] = y.q[j]
                v[i, j] = y.v[j]
        follow(mech, k, y, small[i])
        if not react(mech, k, w, y, False):
            failed += 1
        for j in range(power.shape[1]):
            power[i, j] = y.rate[j]
        k.borne_before = max(k.borne, k.borne_before)
        stored[i] = stored_by_damped(mech.port.damped, mech.port.normals, k.s)
        for j in range(m):
            lam[i, j] = y.lam[j]
        for j in range(y.a.shape[0]):
            a[i, j] = y.a[j]
        for c in range(n_c):
            N[i, c] = max(y.N[c], 0.0)
            for j in range(mech.port.row[c], mech.port.row[c + 1]):
                F[i, j] = y.F[j]
                g[i, j] = 0.0 if y.mode[c] == STICK else y.g[j]
    return failed


@kernel
def follow(mech: Mech, k: Moving, y: State, small: float) -> None:
    """Directions of contacts that slip in a plane from their velocities; slower than ``small`` they keep theirs."""
    some = False
    for c in range(y.mode.shape[0]):
        some = some or (y.mode[c] == SLIP and plane(mech, c))
    if not some:
        return
    move(mech, k, y.t, y.q, y.v)
    if y.lam.shape[0] > 0:
        forces(mech, k, y.lam, y.F, y.N, y.g)
    else:
        contact_slip(mech, k, y.g)
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SLIP and plane(mech, c) and magnitude(mech.port.row, c, y.g) > small:
            point_along(mech.port.row, c, y.g, 1.0, y.n)


@entry
def constraints(
    mech: Mech, k: Moving, t: float, q: Floats, v: Floats, lam: Floats, F: Floats, N: Floats, g: Floats, phi: Floats,
    rate: Floats, Gi: Ints, Gj: Ints, G: Floats,
) -> int:  # fmt: skip
    """Constraints (m,), their rates (m,) and entries of their Jacobian G at an instant; the number of entries."""
    move(mech, k, t, q, v)
    forces(mech, k, lam, F, N, g)
    joint, table, place = mech.joint, mech.joint.table, mech.place
    n_y = k.ddy.shape[0]
    count = 0
    for j in range(joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, lam)
        m = joint.row[j + 1] - joint.row[j]
        for r in range(m):
            row = joint.row[j] + r
            phi[row] = k.phi[row]
            rate[row] = k.phi_rate[row]
            for a in range(n_x):
                slope = k.out[m + r * n_x + a]
                first = table.x_start[j] + a
                for i in range(table.form_start[first], table.form_start[first + 1]):
                    e = table.form_index[i] - 1
                    if not 0 <= e < n_y:
                        continue
                    for b in range(place.y_start[e], place.y_start[e + 1]):
                        Gi[count] = row
                        Gj[count] = place.y_dof[b]
                        G[count] = slope * table.form_coefficient[i] * place_slope(place, k, b)
                        count += 1
    return count
