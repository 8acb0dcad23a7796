"""A chain of blocks on a moving belt, spring to spring: the one-dimensional fault or string of brake blocks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def stick_slip_chain(
    n: int = 10,
    *,
    mass: float = 1.0,
    coupling: float = 100.0,
    ground: float = 1.0,
    damping: float = 0.0,
    belt: float = 0.1,
    normal_force: float = 1.0,
    mu_s: float | Sequence[float] | None = None,
    mu_k: float = 1.0,
    laws: Sequence[fm.FrictionLaw] | None = None,
) -> fm.Scene:
    """Chain of blocks on a moving belt, each tied to its neighbours and to the ground by springs.

    Any consistent units, dimensionless by default.  The blocks start at 0 and move with the belt.

    Parameters
    ----------
    n : int
        Number of blocks.
    mass : float
        Of each block.
    coupling, ground : float
        Stiffness between neighbours and to the ground.
    damping : float
        Damper from each block to the ground.
    belt : float
        Velocity of the belt.
    normal_force : float
        On each block.
    mu_s : float or sequence of n, optional
        Break-away coefficients; default ``1.2 + 0.1 sin(7 i)``, i = 0 ... n-1: rough, but without chance.
    mu_k : float
    laws : sequence of n FrictionLaw, optional
        Another law for each block.

    Returns
    -------
    Scene
        Dofs block1.x, block2.x, ...; contacts "sole1", "sole2", ...

    Notes
    -----
    R. Burridge, L. Knopoff, Model and theoretical seismicity, Bull. Seism. Soc. America 57 (1967) 341-371, with the
    plate at rest and the ground moving.  Two blocks with falling laws (coupling 1.2, HyperbolicStribeck with mu_s of 1
    and 1.3, delta = 3): U. Galvanetto, S. R. Bishop, L. Briseghella, Mechanical stick-slip vibrations, Int. J.
    Bifurcation and Chaos 5 (1995) 637-651.
    """
    if not isinstance(n, int) or n < 1:
        raise fm.SceneError(f"stick_slip_chain: n must be an integer of at least 1; got {shown(n)}")
    if laws is not None and len(laws) != n:
        raise fm.SceneError(f"stick_slip_chain: laws must hold one law for each of {n} blocks; got {len(laws)}")
    if isinstance(mu_s, Sequence) and len(mu_s) != n:
        raise fm.SceneError(f"stick_slip_chain: mu_s must be a number or {n} of them; got {len(mu_s)}")

    def law(i: int) -> fm.FrictionLaw:
        if laws is not None:
            return laws[i]
        if mu_s is None:
            return fm.laws.Coulomb(mu_s=1.2 + 0.1 * math.sin(7 * i), mu_k=mu_k)
        return fm.laws.Coulomb(mu_s=mu_s[i] if isinstance(mu_s, Sequence) else mu_s, mu_k=mu_k)

    moving = fm.Driven("belt", velocity={"x": belt})
    blocks = [fm.Body(f"block{i + 1}", mass=mass, velocity={"x": belt}) for i in range(n)]
    springs = [
        fm.Spring(f"coupling{i + 1}", blocks[i], blocks[i + 1], axis="x", stiffness=coupling) for i in range(n - 1)
    ]
    springs += [fm.Spring(f"ground{i + 1}", block, axis="x", stiffness=ground) for i, block in enumerate(blocks)]
    dampers = [fm.Damper(f"damper{i + 1}", block, axis="x", damping=damping) for i, block in enumerate(blocks)]
    contacts = [
        fm.Contact(f"sole{i + 1}", block, moving, law=law(i), normal_force=normal_force)
        for i, block in enumerate(blocks)
    ]
    return fm.Scene(f"chain of {n} blocks", [*blocks, moving, *springs, *dampers, *contacts], units=DIMENSIONLESS)
