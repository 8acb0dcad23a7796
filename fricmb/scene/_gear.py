"""A gear, with and without losses between its teeth."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.laws import Coulomb
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._rigid import angle_of, start_angle
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class Gear(Joint):
    """Angles in a fixed ratio: ``angle of a - start = -ratio (angle of b - start)``.  Reaction: torque on a.

    Only torques are passed on.  The force between the teeth is not there, nor the load that it brings to the bearings
    of both wheels: friction in their pins does not see it.

    Parameters
    ----------
    name : str
    a, b : RigidBody or one of its points
    ratio : float
        Radius of b over that of a; < 0 for an internal gear or a belt.
    efficiency : float, optional
        Share of the power taken from a that b gets, where a drives, > 0 and < 1; None: no losses.
    efficiency_back : float, optional
        The same where b drives, < 1; None: ``2 - 1/efficiency``, that of a worm.  At 0 and below, which for a worm is
        an efficiency up to a half, the gear locks itself: b cannot drive a, whatever its torque.
    friction : FrictionLaw, optional
        Beside an efficiency, of one direction: its coefficient, over the speed of a, multiplies the loss, which for
        more break-away is ``Coulomb(mu_s=1.2, mu_k=1.0)``; default 1.

    Raises
    ------
    SceneError
        If ends or values are not accepted.

    Notes
    -----
    The loss is dry friction between the teeth, in the ratio of their load: with the tooth load lam (the torque that
    passes, seen at a) and the rate w of a, ``F = -mu |lam| sgn(w)`` acts as ``c F`` on a and ``(1 - c) ratio F``
    against b.  Torques on the wheels are ``lam + c F`` and ``ratio (lam - (1 - c) F)``, from which with the
    efficiencies e and e_b follow

        mu = 2 (1 - e)(1 - e_b)/(1 - e e_b),    c mu = (1 - 2 e_b + e e_b)/(1 - e e_b).

    At rest F is what holds, within ``mu |lam|``: a gear stays stuck in a range of torques on both sides, and that it
    sticks and lets go is located (``sol.events``, ``sol.mode(name)``); ``sol.force(name)`` is F, ``sol.normal_force``
    is ``mu |lam|``.  G. Pelchen, C. Schweiger, M. Otter, Modeling and simulating the efficiency of gearboxes and of
    planetary gearboxes, 2nd Int. Modelica Conference (2002) 257-266; ``2 - 1/efficiency``: all friction on the side of
    a (G. Niemann, H. Winter, Maschinenelemente 3, Springer 1986).

    Examples
    --------
    A worm of efficiency 0.4 holds a load that hangs on its wheel:

    >>> import fricmb as fm
    >>> worm = fm.RigidBody("worm", mass=1.0, inertia=0.01)
    >>> wheel = fm.RigidBody("wheel", mass=1.0, inertia=0.5, position=(1.0, 0.0))
    >>> pins = [fm.Revolute("p1", worm), fm.Revolute("p2", wheel, fm.ground_point(1.0, 0.0))]
    >>> mesh = fm.Gear("mesh", worm, wheel, ratio=30.0, efficiency=0.4)
    >>> load = fm.Torque("load", wheel, value=-60.0)
    >>> sol = fm.simulate(fm.Scene("hoist", [worm, wheel, *pins, mesh, load]), t_end=1.0)
    >>> len(sol.events), int(sol.mode("mesh")[-1])  # it sticks throughout
    (0, 0)
    """

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    ratio: Any
    efficiency: Any = None
    efficiency_back: Any = None

    def __post_init__(self) -> None:
        self._check_losses()
        super().__post_init__()
        self._settle("ratio")
        if self.friction is not None and value_of(self.ratio) == 0.0:
            self._refuse("ratio", self.ratio, "another than 0 beside an efficiency")
        self.local_coordinates()

    def _check_losses(self) -> None:
        if self.efficiency is None:
            for argument in ("efficiency_back", "friction"):
                if getattr(self, argument) is not None:
                    self._refuse(argument, getattr(self, argument), "left out without efficiency")
            return
        e = self._number("efficiency", self.efficiency, above=0.0)
        if value_of(e) >= 1.0:
            self._refuse("efficiency", e, "a finite number > 0 and < 1; without losses it is left out")
        self._set("efficiency", e)
        if self.efficiency_back is not None:
            back = self._number("efficiency_back", self.efficiency_back)
            if value_of(back) >= 1.0:
                self._refuse("efficiency_back", back, "a finite number < 1")
            self._set("efficiency_back", back)
        if self.friction is None:
            self._set("friction", Coulomb(mu_s=1.0))

    def labels(self) -> tuple[str, ...]:
        """Slip is that of a."""
        return ("angle",)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Both angles from their declared start on."""
        held = (("a", self.a), ("b", self.b))
        return tuple(angle_of(self, argument, end) - LinearForm((), start_angle(end)) for argument, end in held)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The teeth."""
        return (x[0] + self.ratio * x[1],)

    def _loss(self) -> tuple[Any, Any]:
        """Coefficient mu of the friction over the tooth load, and the share c of it that acts on a."""
        e, back = self.efficiency, self.efficiency_back
        if back is None:
            return (1 - e) / e, 1
        lost = 2 * (1 - e) * (1 - back)
        return lost / (1 - e * back), (1 - 2 * back + e * back) / lost

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The rate of a, shared between both sides so that both efficiencies are as given."""
        _, share = self._loss()
        return share, -(1 - share) * self.ratio

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """What friction takes of the tooth load."""
        import sympy

        return self._loss()[0] * sympy.Abs(lam[0])
