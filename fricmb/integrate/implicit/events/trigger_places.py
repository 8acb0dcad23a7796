"""Where in the list of triggers each one stands: two a port, then one a joint, then one a kink of a port's load or law.

Of a port's two the first is its slip, or what it could still bear where it sticks, the second its load.  Those of ports
and joints end a mode; at a kink a step ends, and nothing changes but the polynomials.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import is_open
from fricmb.integrate.implicit.scene.problem_structs import Mech


@kernel
def first_joint(mech: Mech) -> int:
    """The trigger of the first joint, behind those of ports."""
    return int(2 * mech.port.joint.shape[0])


@kernel
def first_kink(mech: Mech) -> int:
    """The trigger of the first kink, behind those that end a mode."""
    return int(first_joint(mech) + mech.joint.port.shape[0])


@kernel
def is_gap(mech: Mech, j: int) -> bool:
    """Whether trigger j is the distance of a joint that is open."""
    return is_open(mech, j - first_joint(mech))


@kernel
def is_of_port(mech: Mech, j: int) -> bool:
    """Whether trigger j is one of a port: of port j // 2."""
    return bool(0 <= j < first_joint(mech))
