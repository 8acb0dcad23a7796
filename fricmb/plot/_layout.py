"""Where the parts of a scene stand in a drawing: bodies in columns, one on the other where they touch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from fricmb.scene import GROUND, Contact

WIDTH, HEIGHT, ROW, COLUMN = 1.6, 0.8, 1.0, 3.4


@dataclass(kw_only=True)
class Layout:
    """Places of bodies (centres) and the links between them.

    ``links``: (kind, name, first, second) with the names of bodies, "ground" for the ground.
    """

    places: dict[str, tuple[float, float]] = field(default_factory=dict)
    widths: dict[str, float] = field(default_factory=dict)
    moving: dict[str, bool] = field(default_factory=dict)
    links: list[tuple[str, str, str, str]] = field(default_factory=list)
    contacts: list[tuple[str, str, str]] = field(default_factory=list)


def layout(scene: Any) -> Layout:
    """Lay a scene out."""
    found = Layout()
    contacts = [part for part in scene.parts if isinstance(part, Contact)]
    rows, columns = _stack(scene, contacts)
    for name, row in rows.items():
        carried = [columns[a] for a, b in _touching(contacts) if b == name and a in columns] or [columns[name]]
        middle, reach = 0.5 * (min(carried) + max(carried)), max(carried) - min(carried)
        found.places[name] = (COLUMN * middle, ROW * row)
        found.widths[name] = WIDTH + COLUMN * reach
    found.moving = {body.name: False for body in scene.bodies} | {body.name: True for body in scene.driven}
    for contact in contacts:
        found.contacts.append((contact.name, _owner(contact.a), _owner(contact.b)))
    for part in scene.elements:
        a, b = getattr(part, "a", None), getattr(part, "b", GROUND)
        if a is not None:
            kind = "damper" if "Damper" in type(part).__name__ else "spring"
            found.links.append((kind, part.name, _owner(a), _owner(b)))
    return found


def _owner(end: Any) -> str:
    return "ground" if end is GROUND else str(end.owner.name)


def _touching(contacts: list[Any]) -> list[tuple[str, str]]:
    """Names of the bodies at the ends of each contact."""
    return [(_owner(c.a), _owner(c.b)) for c in contacts]


def _stack(scene: Any, contacts: list[Any]) -> tuple[dict[str, int], dict[str, int]]:
    """Row and column of each body: the first end of a contact on its second."""
    names = [part.name for part in (*scene.bodies, *scene.driven) if part is not GROUND]
    below = dict(_touching(contacts))
    rows: dict[str, int] = {}
    columns: dict[str, int] = {}

    for name in names:
        tower = [name]
        while tower[-1] in below and below[tower[-1]] not in tower and tower[-1] not in rows:
            tower.append(below[tower[-1]])
        # the lowest stands on the ground, or was placed before
        base = rows.get(tower[-1], 0 if tower[-1] == "ground" else 1)
        for height, member in enumerate(reversed(tower)):
            rows[member] = base + height
    rows.pop("ground", None)
    taken: set[tuple[int, int]] = set()
    for name in sorted(names, key=lambda n: rows[n]):
        column = columns.get(below.get(name, ""), 0)
        while (column, rows[name]) in taken:
            column += 1
        columns[name] = column
        taken.add((column, rows[name]))
    return rows, columns
