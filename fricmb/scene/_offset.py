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
    """The same along one letter on one end, under a normal force that is an expression; its work is input.

    ``value`` is ``offset`` times ``per_offset``; ``slot`` names the parameter that the offset is.
    """

    _fixed: ClassVar[tuple[str, ...]] = (*Force._fixed, "offset", "per_offset", "slot")

    _: KW_ONLY
    place: str
    offset: Any
    per_offset: Any
    slot: str

    @property
    def signal_name(self) -> str:
        """That of the contact, with the place."""
        return f"{self.name}.centre.{self.place}"


def centres_of(contact: Contact) -> tuple[Element, ...]:
    """What a contact whose law has an offset pushes with beside the friction about it."""
    if contact.normal_kind == "constant":
        return (Centre(contact.name, contact, law=contact.law, normal_force=contact.normal_force),)
    import sympy

    law: Any = contact.law
    N, offsets, several = sympy.Max(0, contact.normal_force), law.offsets(), isinstance(law.offset, tuple)
    slots = [f"{contact.name}.law.offset{f'.{i}' if several else ''}" for i in range(len(offsets))]
    ends = [(end, sign) for end, sign in ((contact.a, -1.0), (contact.b, 1.0)) if end.movable]
    return tuple(
        CentreForce(
            contact.name, end, axis=letter, value=sign * share * offset * N, place=f"{label}.{letter}.{sign:g}",
            offset=offset, per_offset=sign * share * N, slot=slot,
        )
        for direction, offset, label, slot in zip(contact.directions(), offsets, contact.labels(), slots, strict=True)
        for letter, share in direction.vector
        for end, sign in ends
    )  # fmt: skip
