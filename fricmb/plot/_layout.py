"""Where the parts of a scene stand in a drawing of boxes.

Seen from the side bodies stand in columns, one on the other where they touch; where a contact has two tangential
directions the scene is seen from above, what touches lies on the plate that it touches.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from fricmb.scene import GROUND, Contact

WIDTH, HEIGHT, ROW, COLUMN = 1.6, 0.8, 1.0, 3.4
#: Between a plate's edge and what lies on it, and between neighbours on it.
MARGIN, GAP = (1.0, 0.8), 1.6


@dataclass(kw_only=True)
class Layout:
    """Places of bodies (centres) and their sizes.

    Attributes
    ----------
    places, sizes : dict
        By the name of a body.
    moving : dict of str to bool
        Whether its motion is prescribed.
    order : list of str
        In which bodies are drawn: plates before what lies on them.
    contacts : list of (name, first body, second body)
    above : bool
        Seen from above.
    under : dict of str to str
        What each body lies on, "ground" for none.
    """

    places: dict[str, tuple[float, float]] = field(default_factory=dict)
    sizes: dict[str, tuple[float, float]] = field(default_factory=dict)
    moving: dict[str, bool] = field(default_factory=dict)
    order: list[str] = field(default_factory=list)
    contacts: list[tuple[str, str, str]] = field(default_factory=list)
    above: bool = False
    under: dict[str, str] = field(default_factory=dict)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of all bodies."""
        corners = [(x, y, *self.sizes[name]) for name, (x, y) in self.places.items()] or [(0.0, 0.0, WIDTH, HEIGHT)]
        return (
            min(x - w / 2 for x, _, w, _ in corners),
            max(x + w / 2 for x, _, w, _ in corners),
            min(y - h / 2 for _, y, _, h in corners),
            max(y + h / 2 for _, y, _, h in corners),
        )


def layout(scene: Any) -> Layout:
    """Lay a scene out."""
    contacts = [part for part in scene.parts if isinstance(part, Contact)]
    found = Layout(above=any(len({"x", "y"} & set(contact.labels())) == 2 for contact in contacts))
    found.moving = {body.name: False for body in scene.bodies} | {body.name: True for body in scene.driven}
    for contact in contacts:
        found.contacts.append((contact.name, owner(contact.a), owner(contact.b)))
    if found.above:
        _lay(scene, found)
    else:
        _stand(scene, found)
    return found


def owner(end: Any) -> str:
    """The name of the body that an end belongs to; "ground" for fixed points."""
    return "ground" if end.owner is GROUND else str(end.owner.name)


def _names(scene: Any) -> list[str]:
    return [part.name for part in (*scene.bodies, *scene.driven) if part is not GROUND]


# ---- seen from above


def _lay(scene: Any, found: Layout) -> None:
    """Plates, and on each of them what it carries."""
    names = _names(scene)
    carried: dict[str, list[str]] = {name: [] for name in names}
    for _, a, b in found.contacts:
        # of two that touch, the second carries; nobody is carried twice, nor by what it carries
        if a in carried and b in carried and a not in found.under and a not in _chain(found.under, b):
            found.under[a] = b
            carried[b].append(a)
    for name in names:
        found.under.setdefault(name, "ground")
    left = 0.0
    for name in (name for name in names if found.under[name] == "ground"):
        width, _ = _size(name, carried, found)
        _put(name, left + width / 2, 0.0, carried, found)
        left += width + GAP


def _chain(under: dict[str, str], name: str) -> list[str]:
    chain = [name]
    while chain[-1] in under:
        chain.append(under[chain[-1]])
    return chain


def _size(name: str, carried: dict[str, list[str]], found: Layout) -> tuple[float, float]:
    inner = [_size(other, carried, found) for other in carried[name]]
    if inner:
        width = sum(w for w, _ in inner) + GAP * (len(inner) - 1) + 2 * MARGIN[0]
        found.sizes[name] = (width, max(h for _, h in inner) + 2 * MARGIN[1])
    else:
        found.sizes[name] = (WIDTH, HEIGHT)
    return found.sizes[name]


def _put(name: str, x: float, y: float, carried: dict[str, list[str]], found: Layout) -> None:
    found.places[name] = (x, y)
    found.order.append(name)
    left = x - found.sizes[name][0] / 2 + MARGIN[0]
    for other in carried[name]:
        width = found.sizes[other][0]
        _put(other, left + width / 2, y, carried, found)
        left += width + GAP


# ---- seen from the side


def _stand(scene: Any, found: Layout) -> None:
    rows, columns = _stack(scene, found.contacts)
    touching = [(a, b) for _, a, b in found.contacts]
    for name, row in rows.items():
        carried = [columns[a] for a, b in touching if b == name and a in columns] or [columns[name]]
        middle, reach = 0.5 * (min(carried) + max(carried)), max(carried) - min(carried)
        found.places[name] = (COLUMN * middle, ROW * row)
        found.sizes[name] = (WIDTH + COLUMN * reach, HEIGHT)
        found.under[name] = next((b for a, b in touching if a == name), "ground")
    found.order = list(rows)


def _stack(scene: Any, contacts: list[tuple[str, str, str]]) -> tuple[dict[str, int], dict[str, int]]:
    """Row and column of each body: the first end of a contact on its second."""
    names = _names(scene)
    below = {a: b for _, a, b in contacts}
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
