"""The law by which velocities change in impacts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._joint import Joint
from fricmb.scene._part import Part
from fricmb.values import is_one_of, value_of

if TYPE_CHECKING:
    from fricmb.scene._scene import Scene


@dataclass(frozen=True, eq=False)
class ImpactLaw(Part):
    """Law of impact of a scene: the meaning of its coefficients of restitution.  Newton's law by default.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    law : str
        "newton": a law of velocities.  Each contact parts at ``e`` times its speed of approach.  "poisson": a law of
        impulses.  In a first phase contacts are compressed until none approaches; in a second one each gives back ``e``
        times its normal impulse of the first.
    several : str
        How contacts hit or held at one instant are solved: "together", in one problem with a law for each contact; or
        "in_turn": each contact that approaches has an impact of its own, the fastest first, until none approaches any
        more.
    painleve : str
        Where a contact with restitution slips and no friction force, or more than one, fits: "end", the run ends with
        an error; or "impact", an impact without collision stops its slip (events "impact" with approach 0).

    Raises
    ------
    SceneError
        If the law is another one; by a scene, if it holds two of these, or ``tangential_restitution`` beside "poisson".

    Notes
    -----
    A single contact without friction has the same impacts by both.  With friction that changes the direction of slip
    within an impact, Newton's law may gain energy, at which a run ends with an error; Poisson's does not.  Where
    several contacts are hit or held together they differ: by Newton's law a contact that holds stays closed unless it
    is thrown open, by Poisson's it gives back a part of its impulse as well.

    Impacts in turn describe bodies with a little air between them: in a row of equal elastic balls the last one leaves
    with the whole speed of the first, whereas solved together all of them move.  The fastest approach comes first; of
    two alike, the first in the order of the parts.  Contacts whose bounces come to rest, and contacts that still
    approach after 400 impacts, are brought to rest together.

    A rod that slides on its tip may be pressed into the floor by its own friction, without bound (Painleve).  An impact
    without collision is the solution of the law of impact beside that of no impulse: the tip stops, and by Poisson's
    law is thrown up with ``e`` times the impulse that it took (F. Genot and B. Brogliato, European Journal of Mechanics
    A 18 (1999) 653).

    Each phase obeys Coulomb's law by the slip at its end, ``-Lambda_T in mu Lambda_N Sgn(gamma_T)`` (F. Pfeiffer and
    C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 8, without restitution along the slip):

        compression   0 <= gamma_N complementary to Lambda_N >= 0
        expansion     0 <= gamma_N complementary to Lambda_N - e Lambda_N(compression) >= 0

    Examples
    --------
    Two balls in touch fall on a floor, the upper one twice as heavy: by Newton's law both stay in touch, by Poisson's
    the upper one leaves with the speed of the approach.

    >>> import fricmb as fm
    >>> a = fm.Body("a", mass=1.0, position={"y": 1.0}, velocity={"y": -1.0}, axes="y")
    >>> b = fm.Body("b", mass=2.0, position={"y": 2.0}, velocity={"y": -1.0}, axes="y")
    >>> floor = fm.Stop("floor", a, axis="y", lower=0.0, restitution=0.5)
    >>> touch = fm.Stop("touch", b, a, axis="y", lower=1.0, restitution=1.0)
    >>> for law in ("newton", "poisson"):
    ...     scene = fm.Scene("balls", [a, b, floor, touch, fm.ImpactLaw("impacts", law=law)])
    ...     print([float(round(v, 12)) for v in fm.simulate(scene, t_end=1.5).v[:, -1]])
    [0.5, 0.5]
    [0.0, 1.0]

    Three equal balls in touch, together and in turn:

    >>> balls = [fm.Body(f"b{i}", mass=1.0, position={"x": 1.0 * i}, velocity={"x": 1.0 - (i > 0)}) for i in range(3)]
    >>> touch = [fm.Stop(f"t{i}", balls[i + 1], balls[i], axis="x", lower=1.0, restitution=1.0) for i in range(2)]
    >>> for several in ("together", "in_turn"):
    ...     scene = fm.Scene("row", [*balls, *touch, fm.ImpactLaw("impacts", several=several)])
    ...     print([float(round(v, 3)) + 0.0 for v in fm.simulate(scene, t_end=1.0).v[:, -1]])
    [-0.333, 0.667, 0.667]
    [0.0, 0.0, 1.0]
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "law", "several", "painleve")
    _: KW_ONLY
    law: str = "newton"
    several: str = "together"
    painleve: str = "end"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not is_one_of(self.law, "newton", "poisson"):
            self._refuse("law", self.law, "'newton' or 'poisson'")
        if not is_one_of(self.several, "together", "in_turn"):
            self._refuse("several", self.several, "'together' or 'in_turn'")
        if not is_one_of(self.painleve, "end", "impact"):
            self._refuse("painleve", self.painleve, "'end' or 'impact'")


def impact_law(parts: Iterable[Part]) -> ImpactLaw:
    """The law of impact of these parts, by default Newton's, all together."""
    return next((part for part in parts if isinstance(part, ImpactLaw)), ImpactLaw("impacts"))


def check_impact_law(scene: Scene) -> None:
    """At most one law, that all contacts can obey."""
    laws = [part for part in scene.parts if isinstance(part, ImpactLaw)]
    if len(laws) > 1:
        raise SceneError(f"Scene {scene.name!r}: parts hold two laws of impact, {laws[0].name!r} and {laws[1].name!r}")
    if not laws or laws[0].law != "poisson":
        return
    for part in scene.parts:
        given = getattr(part, "tangential_restitution", None) if isinstance(part, Joint) else None
        if given is not None and float(value_of(given)) != 0.0:
            part._refuse("tangential_restitution", given, "left out or 0 beside a law of impact by Poisson")
