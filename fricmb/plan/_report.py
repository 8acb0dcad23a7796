"""What a plan tells: counts, what is left out or not run and why, what is worth knowing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from fricmb.plan._links import Flags, Links
from fricmb.plan._plan import Island, Omission, short_list
from fricmb.scene import Body, Contact, Driven, Joint, MatrixElement, ModalBody, Part, RigidBody, Scene, SpaceBody


def counts(parts: Iterable[Part], links: Links, inside: Flags, n: int, islands: int, still: int) -> dict[str, int]:
    """Numbers of what is built."""
    contacts = [links.parts[i] for i in np.flatnonzero(inside & links.rubs).tolist()]
    rows = [len(contact.labels()) for contact in contacts if isinstance(contact, Contact)]
    of_facts = np.bincount(links.kind[inside & (links.kind >= 0)], minlength=len(links.kinds)).tolist()
    facts = list(zip(links.kinds, of_facts, strict=True))
    types = Counter(map(type, parts))

    def number(*kinds: type) -> int:
        return sum(count for kind, count in types.items() if issubclass(kind, kinds))

    joints = number(Joint)
    dry = [part for part in parts if isinstance(part, Joint) and part.friction is not None] if joints else []
    return {
        "bodies": number(Body, ModalBody, RigidBody, SpaceBody),
        "driven bodies": number(Driven),
        "degrees of freedom": n,
        "linear elements": sum(k for f, k in facts if not f.nonlinear and (f.stiffness or f.damping or f.constant)),
        "nonlinear elements": sum(k for f, k in facts if f.nonlinear),
        "matrix elements": number(MatrixElement),
        "forces of time": sum(k for f, k in facts if f.signal),
        "contacts": len(contacts) + len(dry),
        "contact rows": sum(rows) + sum(joint.slip_rows for joint in dry),
        "law states": sum(c.law.n_states(d) for d, c in zip(rows, contacts, strict=True) if c.law.states)  # type: ignore
        + sum(joint.friction.n_states(joint.slip_rows) for joint in dry if joint.friction is not None),
        "islands": islands,
        "islands at rest": still,
        **({"joints": joints} if joints else {}),
    }


def outside(scene: Scene, links: Links, kept: Flags, inside: Flags) -> list[Omission]:
    """What cannot influence anything that is observed, island by island."""
    rest = np.flatnonzero(~kept)
    if not rest.size:
        return []
    label, mine = links.labels, ~inside & (links.first >= 0)
    acting: dict[int, list[str]] = {}
    for i in np.flatnonzero(mine).tolist():
        acting.setdefault(int(label[links.first[i]]), []).append(links.parts[i].name)
    omitted = []
    for group in links.groups(rest.tolist()):
        others = dict.fromkeys(acting.get(int(label[group[0]]), ()))
        names = (*(scene.dof_names[i] for i in group.tolist()), *others)
        why = "cannot influence what is observed"
        omitted.append(Omission(what=short_list(names), why=why, names=names))
    return omitted


def empty(links: Links, inside: Flags) -> list[Omission]:
    """Elements of which nothing is left, those of one type and reason together."""
    found: dict[tuple[str, str], list[str]] = {}
    said: dict[tuple[Any, ...], tuple[str, str]] = {}
    for i in np.flatnonzero(inside & links.idle & (links.kind >= 0)).tolist():
        part = links.parts[i]
        numbers = part.plain_numbers()
        key = (type(part), numbers)
        if numbers is None:
            found.setdefault(_why(part), []).append(part.name)
            continue
        if key not in said:
            said[key] = _why(part)
        found.setdefault(said[key], []).append(part.name)
    return [
        Omission(what=f"{kind} {short_list(tuple(names))}", why=why, names=tuple(names))
        for (kind, why), names in found.items()
    ]


def zeros(part: Part) -> tuple[str, ...]:
    """Numbers of a part that are 0."""
    return tuple([path for path, value in part.numeric_slots().items() if np.ndim(value) == 0 and value == 0.0])


def _why(part: Part) -> tuple[str, str]:
    return type(part).__name__, ", ".join(f"{path} = 0" for path in zeros(part)) or "has no effect"


def resting(scene: Scene, islands: Iterable[Island]) -> list[Omission]:
    """Islands that stay where the scene puts them."""
    still = [island for island in islands if island.inert]
    if not still:
        return []
    q, v = scene.initial_values()
    place = {name: i for i, name in enumerate(scene.dof_names)}
    there, moves = q.tolist(), v.tolist()
    found = []
    for island in still:
        places = [place[name] for name in island.dofs]
        if not any(moves[i] or (island.held and there[i]) for i in places):
            names = (*island.dofs, *island.parts)
            why = "at rest throughout; no initial motion, and nothing that acts"
            found.append(Omission(what=str(island), why=why, names=names))
    return found


def remarks(scene: Scene) -> list[str]:
    """What laws say of themselves, and what is solved in place of bodies without mass."""
    laws = {id(part.law): part for part in scene.frictional}
    said = [(part.name, part.law.remark()) for part in laws.values() if part.law is not None]
    notes: tuple[str, ...] = scene._cache.get("notes", ())
    return [*notes, *(f"{name}: {text}" for name, text in said if text)]


def unloaded(idle: tuple[str, ...]) -> list[str]:
    """Contacts that act on nothing."""
    return [f"contacts without normal force, which act on nothing: {short_list(idle)}"] if idle else []


def vanishing(links: Links, inside: Flags) -> list[str]:
    """Nonlinear terms that vanish for the given numbers."""
    kinds = [f.could_be_nonlinear and not f.nonlinear and not f.empty for f in links.kinds]
    these = np.flatnonzero(inside & np.array([*kinds, False])[links.kind]).tolist()
    could = [links.parts[i].name for i in these]
    if not could:
        return []
    return [f"nonlinear terms that vanish for the given numbers, and are not built: {short_list(tuple(could))}"]
