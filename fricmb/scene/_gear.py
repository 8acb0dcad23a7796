"""A gear, with and without losses between its teeth."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.laws import Coulomb
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._rigid import angle_of, start_angle, start_place
from fricmb.values import is_list, value_of


@dataclass(frozen=True, eq=False)
class Gear(Joint):
    """Angles in a fixed ratio: ``angle of a - start = -ratio (angle of b - start)``.  Reaction: torque on a.

    Without ``pressure_angle`` only torques are passed on: bearings of the wheels do not feel the force between the
    teeth, nor does friction in their pins.

    Parameters
    ----------
    name : str
    a, b : RigidBody or one of its points
    ratio : float
        Radius of b over that of a, not 0; < 0 for an internal gear or a belt.
    pressure_angle : float, optional
        Of the teeth, in radians, between -pi/2 and pi/2 (20 degrees are 0.349): the force between them acts on both
        wheels at the pitch point between their centres, on lines that lean by this angle.  Its sign names the flank
        that carries: > 0 while the torque on a is counter-clockwise, < 0 while it is clockwise (under a torque the
        other way the force that parts the wheels would have the wrong sign).  The distance of the centres must not
        change; ``sol.stats.notes`` says by how much it did.
    centres : (float, float, float, float), optional
        X and y of the centre of a, then of b, for the pressure angle; default: as the ends are declared.
    efficiency : float, optional
        Power that b gets over power taken from a, where a drives; > 0 and < 1.  None: no losses.
    efficiency_back : float, optional
        The same where b drives, < 1; None: ``2 - 1/efficiency``, that of a worm.  At 0 and below, which for a worm is
        an efficiency up to a half, the gear locks itself: b cannot drive a, whatever its torque.
    friction : FrictionLaw, optional
        With an efficiency: a law of one direction whose coefficient, a function of the speed of a, multiplies the loss.
        Default 1; under ``Coulomb(mu_s=1.2, mu_k=1.0)`` the gear breaks away at 1.2 times the loss in motion.

    Raises
    ------
    SceneError
        If ends or values are not accepted.

    Notes
    -----
    With the centres apart by ``D e`` the pitch radius of a is ``r = D/(1 + ratio)``, and the force on a is
    ``lam n/(r cos alpha)`` with the torque lam on a and ``n = cos(alpha) t - sin(alpha) e``, t being e turned by 90
    degrees.

    The loss is dry friction between the teeth, in the ratio of their load: with the tooth load lam (the torque that
    passes, seen at a) and the rate w of a, ``F = -mu |lam| sgn(w)`` acts as ``c F`` on a and ``(1 - c) ratio F``
    against b.  Torques on the wheels are ``lam + c F`` and ``ratio (lam - (1 - c) F)``, from which with the
    efficiencies e and e_b follow

        mu = 2 (1 - e)(1 - e_b)/(1 - e e_b),    c mu = (1 - 2 e_b + e e_b)/(1 - e e_b).

    At rest F takes the value that holds, within ``mu |lam|``: a gear stays stuck in a range of torques on both sides,
    and both transitions are located (``sol.events``, ``sol.mode(name)``); ``sol.force(name)`` is F,
    ``sol.normal_force`` is ``mu |lam|``.  G. Pelchen, C. Schweiger, M. Otter, Modeling and simulating the efficiency of
    gearboxes and of planetary gearboxes, 2nd Int. Modelica Conference (2002) 257-266; ``2 - 1/efficiency``: all
    friction on the side of a (G. Niemann, H. Winter, Maschinenelemente 3, Springer 1986).

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
    pressure_angle: Any = None
    centres: Any = None
    efficiency: Any = None
    efficiency_back: Any = None

    def __post_init__(self) -> None:
        self._check_losses()
        super().__post_init__()
        self._settle("ratio")
        if value_of(self.ratio) == 0.0:
            self._refuse("ratio", self.ratio, "another than 0")
        if self.pressure_angle is not None:
            self._check_teeth()
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

    def _check_teeth(self) -> None:
        angle = self._number("pressure_angle", self.pressure_angle)
        if not abs(value_of(angle)) < math.pi / 2:
            self._refuse("pressure_angle", angle, "a number between -pi/2 and pi/2")
        self._set("pressure_angle", angle)
        one, other = self._centres()
        if 1.0 + value_of(self.ratio) == 0.0 or math.dist(one, other) == 0.0:
            self._refuse("pressure_angle", angle, "left out where centres are in one place, or the ratio is -1")
        self._set("centres", (*one, *other))

    def _centres(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """As given, else as declared; kept, since whoever compares gears reads their own fields alone."""
        if self.centres is not None:
            if not is_list(self.centres) or len(self.centres) != 4:
                self._refuse("centres", self.centres, "four numbers, x and y of a, then of b")
            ax, ay, bx, by = (float(value_of(self._number("centres", entry))) for entry in self.centres)
            return (ax, ay), (bx, by)
        found = [start_place(end) or {} for end in (self.a, self.b)]
        first, second = ((at["x"], at["y"]) for at in found)
        return first, second

    def _mesh(self, x: Any, y: Any) -> Any:
        """What the centres have moved along the line of action, over the arm of the force about the centre of a."""
        import sympy

        ax, ay, bx, by = self.centres
        along = bx - ax, by - ay
        whole = along[0] ** 2 + along[1] ** 2
        # e/r of the unit vector e between the centres, by D e = r (1 + ratio) e
        e = tuple((1 + self.ratio) * c / whole for c in along)
        lean = sympy.tan(self.pressure_angle)
        return (-e[1] - lean * e[0]) * (x + along[0]) + (e[0] - lean * e[1]) * (y + along[1])

    def labels(self) -> tuple[str, ...]:
        """Slip is that of a."""
        return ("angle",)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Both angles from their declared start on; with a pressure angle also the vector between the centres."""
        held = (("a", self.a), ("b", self.b))
        turned = tuple(angle_of(self, argument, end) - LinearForm((), start_angle(end)) for argument, end in held)
        if self.pressure_angle is None:
            return turned
        return (*turned, *(self.a.motion(c) - self.b.motion(c) for c in "xy"))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The teeth."""
        mesh = 0 if self.pressure_angle is None else self._mesh(x[2], x[3])
        return (x[0] + self.ratio * x[1] + mesh,)

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
