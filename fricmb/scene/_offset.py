"""What a contact whose cone has its centre off 0 pushes with beside the friction about 0."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from fricmb.laws import FrictionLaw
from fricmb.scene._element import Element
from fricmb.scene._force import Force
from fricmb.scene._forms import LinearForm

if TYPE_CHECKING:
    from fricmb.scene._contact import Contact


@dataclass(frozen=True, eq=False)
class Centre(Element):
    """The force ``-offset N`` along the directions of a contact; its work is friction loss.

    It bears the contact's name, and its numbers those of the contact's: law and normal force.
    """

    rubs: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "contact")

    contact: Contact
    _: KW_ONLY
    law: FrictionLaw
    normal_force: Any

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Relative position along each direction."""
        return tuple(direction.form for direction in self.contact.directions())

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Of a constant force."""
        return sum(c * self.normal_force * e for c, e in zip(self.law.offsets(), x, strict=True))


@dataclass(frozen=True, eq=False)
class CentreForce(Force):
    """The same along one letter on one end, under a normal force that is an expression; its work is input."""

    _: KW_ONLY
    place: str

    @property
    def signal_name(self) -> str:
        """That of the contact, with the place."""
        return f"{self.name}.centre.{self.place}"


def centres_of(contact: Contact) -> tuple[Element, ...]:
    """What a contact whose law has an offset pushes with beside the friction about it."""
    if contact.normal_kind == "constant":
        return (Centre(contact.name, contact, law=contact.law, normal_force=contact.normal_force),)
    import sympy

    N = sympy.Max(0, contact.normal_force)
    ends = [(end, sign) for end, sign in ((contact.a, -1.0), (contact.b, 1.0)) if end.movable]
    return tuple(
        CentreForce(contact.name, end, axis=letter, value=sign * share * offset * N, place=f"{label}.{letter}.{sign:g}")
        for direction, offset, label in zip(contact.directions(), contact.law.offsets(), contact.labels(), strict=True)
        for letter, share in direction.vector
        for end, sign in ends
    )
