"""What a plan tells: counts, what is left out or not run and why, what is worth knowing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from fricmb.plan._links import Link, Links
from fricmb.plan._plan import Island, Omission, short_list
from fricmb.scene import Body, Contact, Driven, Joint, MatrixElement, ModalBody, Part, RigidBody, Scene


def counts(parts: Iterable[Part], links: Sequence[Link], n: int, islands: int, still: int) -> dict[str, int]:
    """Numbers of what is built."""
    contacts = [link.part for link in links if isinstance(link.part, Contact)]
    rows = [len(contact.directions()) for contact in contacts]
    dry = [part for part in parts if isinstance(part, Joint) and part.friction is not None]
    facts = [link.facts for link in links if link.facts is not None]
    kinds: Counter[str] = Counter()
    for part in parts:
        kinds["bodies"] += isinstance(part, Body | ModalBody | RigidBody)
        kinds["joints"] += isinstance(part, Joint)
        kinds["driven bodies"] += isinstance(part, Driven)
        kinds["matrix elements"] += isinstance(part, MatrixElement)
    return {
        "bodies": kinds["bodies"],
        "driven bodies": kinds["driven bodies"],
        "degrees of freedom": n,
        "linear elements": sum(not f.nonlinear and (f.stiffness or f.damping or f.constant) for f in facts),
        "nonlinear elements": sum(f.nonlinear for f in facts),
        "matrix elements": kinds["matrix elements"],
        "forces of time": sum(f.signal for f in facts),
        "contacts": len(contacts) + len(dry),
        "contact rows": sum(rows) + len(dry),
        "law states": sum(contact.law.n_states(d) for d, contact in zip(rows, contacts, strict=True))
        + sum(joint.friction.n_states(1) for joint in dry if joint.friction is not None),
        "islands": islands,
        "islands at rest": still,
        **({"joints": kinds["joints"]} if kinds["joints"] else {}),
    }


def outside(scene: Scene, links: Links, kept: set[int], inside: Sequence[Link]) -> list[Omission]:
    """What cannot influence anything that is observed, island by island."""
    rest = [i for i in range(links.n) if i not in kept]
    built = {link.part.name for link in inside}
    omitted = []
    for group in links.groups(rest):
        acting = dict.fromkeys(link.part.name for dof in group for link in links.acting[dof])
        names = (*(scene.dof_names[i] for i in group), *(name for name in acting if name not in built))
        why = "cannot influence what is observed"
        omitted.append(Omission(what=short_list(names), why=why, names=names))
    return omitted


def empty(links: Iterable[Link]) -> list[Omission]:
    """Elements of which nothing is left, those of one type and reason together."""
    found: dict[tuple[str, str], list[str]] = {}
    for link in links:
        if link.facts is not None and link.idle:
            part = link.part
            zero = [path for path, value in part.numeric_slots().items() if np.ndim(value) == 0 and value == 0.0]
            why = ", ".join(f"{path} = 0" for path in zero) or "has no effect"
            found.setdefault((type(part).__name__, why), []).append(part.name)
    return [
        Omission(what=f"{kind} {short_list(tuple(names))}", why=why, names=tuple(names))
        for (kind, why), names in found.items()
    ]


def resting(scene: Scene, islands: Iterable[Island]) -> list[Omission]:
    """Islands that stay where the scene puts them."""
    q, v = scene.initial_values()
    place = {name: i for i, name in enumerate(scene.dof_names)}
    found = []
    for island in islands:
        if not island.inert:
            continue
        places = [place[name] for name in island.dofs]
        if island.rests(q[places], v[places]):
            names = (*island.dofs, *island.parts)
            why = "at rest throughout; no initial motion, and nothing that acts"
            found.append(Omission(what=str(island), why=why, names=names))
    return found


def unloaded(idle: tuple[str, ...]) -> list[str]:
    """Contacts that act on nothing."""
    return [f"contacts without normal force, which act on nothing: {short_list(idle)}"] if idle else []


def vanishing(links: Iterable[Link]) -> list[str]:
    """Nonlinear terms that vanish for the given numbers."""
    facts = [(link.part.name, link.facts) for link in links if link.facts is not None]
    could = [name for name, f in facts if f.could_be_nonlinear and not f.nonlinear and not f.empty]
    if not could:
        return []
    return [f"nonlinear terms that vanish for the given numbers, and are not built: {short_list(tuple(could))}"]
