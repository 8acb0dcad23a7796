"""The scenes of the suite."""

from __future__ import annotations

import math
from functools import partial

import fricmb as fm
from fricmb import models
from fricmb.bench import _closed as closed
from fricmb.bench._case import SceneCase
from fricmb.bench._reference import shipped

_CERTIFIED = "event-driven in 30-digit arithmetic, checked by a second method"


def stribeck_belt(damping: float = 0.0) -> fm.Scene:
    """The belt with a coefficient that falls with the slip speed."""
    law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05, exponent=1.0)
    scene: fm.Scene = models.belt_oscillator(law=law, damping=damping)
    return scene


def two_blocks() -> fm.Scene:
    """Two coupled blocks on a belt, after Galvanetto, Bishop and Briseghella (1995)."""
    laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
    scene: fm.Scene = models.stick_slip_chain(2, coupling=1.2, laws=laws)
    return scene


def rough_chain() -> fm.Scene:
    """Twenty blocks whose break-away rises along the chain."""
    scene: fm.Scene = models.stick_slip_chain(20, mu_s=[1.2 + 0.02 * i for i in range(20)])
    return scene


def stewart() -> fm.Scene:
    """D. E. Stewart's blocks in a row: three springs, three dampers, three contacts that all come to rest."""
    blocks = [fm.Body(f"b{i}", mass=1.0, position={"x": q}, velocity={"x": v}) for i, (q, v) in enumerate(_STEWART)]
    springs = [fm.Spring("s0", blocks[0], axis="x", stiffness=1.0)]
    springs += [fm.Spring(f"s{i}", blocks[i - 1], blocks[i], axis="x", stiffness=1.0) for i in (1, 2)]
    dampers = [fm.Damper(f"d{i}", block, axis="x", damping=1.0) for i, block in enumerate(blocks)]
    rub = fm.laws.Coulomb(mu_s=1.0)
    contacts = [fm.Contact(f"c{i}", block, law=rub, normal_force=0.3) for i, block in enumerate(blocks)]
    return fm.Scene("Stewart's blocks", [*blocks, *springs, *dampers, *contacts])


_STEWART = ((-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def rabinowicz() -> fm.Scene:
    """A mass with LuGre friction, pulled at 0.1 through a spring of stiffness 2."""
    law = fm.laws.LuGre(sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, mu_s=1.5, mu_k=1.0, v_s=1e-3)
    mass, hand = fm.Body("mass", mass=1.0), fm.Driven("hand", velocity={"x": 0.1})
    spring = fm.Spring("spring", mass, hand, axis="x", stiffness=2.0)
    return fm.Scene("Rabinowicz", [mass, hand, spring, fm.Contact("sole", mass, law=law, normal_force=1.0)])


_FINE = (1e-2, 3e-3, 1e-3)
_BRAKES = tuple(
    SceneCase(
        name=f"brake{case}", title=f"brake, case {case}", build=partial(models.brake4dof, case),
        reference=partial(shipped, f"p1_{case}"), steps=_FINE, quick=case == "2", source=_CERTIFIED,
    )
    for case in ("1", "2", "5")
)  # fmt: skip
_HELD = tuple(
    SceneCase(
        name=f"brake2_{name}", title=f"brake, case 2, {what}", build=partial(models.brake4dof, "2", **arguments),
        reference=partial(shipped, f"brake2_{name}"), steps=_FINE,
        source="Taylor series in 34 digits, checked by collocation in long double",
    )
    for name, what, arguments in (
        ("static", "static friction 20", {"mu_s_N": 20.0}),
        ("stribeck", "Stribeck from 18 to 12", {"law": fm.laws.Stribeck(mu_s=1.2, mu_k=0.8, v_s=1.0)}),
    )
)  # fmt: skip
_BELTS = (
    SceneCase(
        name="belt", title="mass on a belt, mu_s > mu_k", build=models.belt_oscillator,
        reference=partial(shipped, "p2_a"), steps=_FINE, quick=True, source=_CERTIFIED,
    ),
    SceneCase(
        name="belt_damped", title="mass on a belt, damped", build=partial(models.belt_oscillator, damping=0.05),
        reference=partial(shipped, "p2_b"), steps=_FINE, source=_CERTIFIED,
    ),
    SceneCase(
        name="belt_stribeck", title="mass on a belt, Stribeck", build=stribeck_belt,
        reference=partial(shipped, "p2_s"), steps=_FINE, quick=True, source=_CERTIFIED,
    ),
    SceneCase(
        name="belt_stribeck_damped", title="mass on a belt, Stribeck, damped",
        build=partial(stribeck_belt, 0.05), reference=partial(shipped, "p2_sb"), steps=_FINE, source=_CERTIFIED,
    ),
)  # fmt: skip
_OSCILLATORS = (
    SceneCase(
        name="free", title="oscillator coming to rest", build=partial(models.friction_oscillator, x0=2.7183),
        reference=closed.free_oscillator, steps=_FINE, source="closed form",
    ),
    *(
        SceneCase(
            name=f"forced{w}", title=f"driven oscillator, frequency {w}",
            build=partial(models.friction_oscillator, friction=0.2, amplitude=0.5, frequency=w),
            reference=partial(shipped, f"p3_forced_w{w}_f0.2"), steps=_FINE, source=_CERTIFIED,
        )
        for w in (0.5, 0.8, 1.5)
    ),
)  # fmt: skip
_PLANES = tuple(
    SceneCase(
        name=f"planar_{name}", title=f"mass on a rough plane, {what}",
        build=partial(models.planar_oscillator, friction=friction, position=position, velocity=velocity),
        reference=partial(shipped, f"p5_{name}"), steps=_FINE, quick=name == "b", source=_CERTIFIED,
    )
    for name, what, friction, position, velocity in (
        ("a", "one close pass", 0.3, (2.0, 0.0), (0.0, 1.7)),
        ("b", "ten close passes", 0.1, (2.0, 0.0), (0.0, 1e-2)),
        ("d", "passes down to 1e-5", 0.05, (2.0, 0.3), (0.0, 1e-4)),
        ("e", "released from rest", 0.1, (2.0, 1.0), (0.0, 0.0)),
    )
)  # fmt: skip
_MANY = (
    SceneCase(
        name="two_blocks", title="two blocks on a belt", build=two_blocks, reference=partial(shipped, "p4_vdr0.1"),
        steps=_FINE, source=_CERTIFIED,
    ),
    SceneCase(
        name="stewart", title="Stewart's three blocks", build=stewart, reference=closed.stewart, steps=_FINE,
        quick=True, source="digits of the literature (8)",
    ),
    SceneCase(
        name="stack", title="stack of three blocks", build=models.block_stack, reference=closed.stack,
        steps=_FINE, quick=True, source="closed form",
    ),
    SceneCase(
        name="puck", title="puck on a belt", build=models.puck_on_belt, reference=closed.puck, steps=_FINE,
        source="closed form",
    ),
    SceneCase(
        name="chain10", title="chain of 10 blocks", build=partial(models.stick_slip_chain, 10),
        reference=partial(shipped, "chain10"), steps=_FINE[:2], source="self-converged to 1e-13",
    ),
    SceneCase(
        name="chain20", title="chain of 20 blocks, 514 transitions", build=rough_chain,
        reference=partial(shipped, "p6"), source=_CERTIFIED,
    ),
    SceneCase(
        name="lugre", title="LuGre, pulled through a spring", build=rabinowicz, reference=closed.rabinowicz,
        source="two independent methods",
    ),
)  # fmt: skip
_RINGING = {"mode3": 2.0, "mode5": 1.0}
_PADS = tuple(
    SceneCase(
        name=f"pad_rotor_{name}", title=f"pad and rotor, {what}",
        build=partial(models.pad_rotor, *counts, speed=speed, rotor_velocity=_RINGING),
        reference=partial(shipped, f"pad_rotor_{name}"), steps=(1e-5, 3e-6, 1e-6),
        source="Taylor series in 34 digits, checked by collocation in long double",
    )
    for name, what, counts, speed in (
        ("slides", "4 + 7 modes, three contacts that slide", (4, 6, 3), 1.0),
        ("stops", "3 + 5 modes, one contact, stick-slip before it stands", (3, 4, 1), 0.5),
    )
)  # fmt: skip

SCENES: tuple[SceneCase, ...] = (*_BRAKES, *_HELD, *_BELTS, *_OSCILLATORS, *_PLANES, *_MANY, *_PADS)
