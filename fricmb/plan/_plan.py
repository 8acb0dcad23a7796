"""What will be built from a scene, and what is left out and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb._facade import facade
from fricmb.scene import Branch, Loop


@dataclass(frozen=True, kw_only=True)
class Omission:
    """Something that is not built or not run, and why; ``names`` of dofs and parts."""

    what: str
    why: str
    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.what}: {self.why}"


@dataclass(frozen=True, kw_only=True)
class Selection:
    """A part of a scene that is built as arrays of its own: degrees of freedom and parts, in the order of the scene."""

    dofs: tuple[str, ...]
    parts: tuple[str, ...]

    @property
    def key(self) -> tuple[Any, ...]:
        """What distinguishes the arrays of two selections of one scene."""
        return self.dofs, self.parts


@dataclass(frozen=True, kw_only=True)
class Island:
    """Degrees of freedom and parts that can influence each other, and nothing else.

    Attributes
    ----------
    dofs, parts, bodies : tuple of str
        Degrees of freedom, parts that act on them, and the bodies they belong to.
    inert : bool
        Nothing in it can set it in motion.
    held : bool
        Its forces depend on position: inert, it rests at the origin alone, else anywhere.
    """

    dofs: tuple[str, ...]
    parts: tuple[str, ...]
    bodies: tuple[str, ...] = ()
    inert: bool = False
    held: bool = True

    @property
    def selection(self) -> Selection:
        """What to build for it."""
        return Selection(dofs=self.dofs, parts=tuple(dict.fromkeys((*self.bodies, *self.parts))))

    def rests(self, q: Any, v: Any) -> bool:
        """Whether it stays where it is, provably, from positions and velocities (n,) of its own."""
        return bool(self.inert and not v.any() and not (self.held and q.any()))

    def __str__(self) -> str:
        return short_list(self.dofs) + (f" with {short_list(self.parts)}" if self.parts else "")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What will be built from a scene.

    Attributes
    ----------
    scene : str
        Name of the scene.
    dofs, parts : tuple of str
        Degrees of freedom and parts that are built, in the order of the scene.
    islands : tuple of Island
        Independent groups among them, each run on its own, with steps of its own.
    idle : tuple of str
        Contacts without normal force: they act on nothing, and are filled in after the run.
    counts : dict of str to int
        "bodies", "driven bodies", "degrees of freedom", "linear elements", "nonlinear elements", "matrix elements",
        "forces of time", "contacts", "contact rows", "law states", "islands", "islands at rest".
    left_out : tuple of Omission
        What is not built, and why.
    resting : tuple of Omission
        Islands that are not run, since from the declared start they provably stay at rest.
    notes : tuple of str
        What is worth knowing beside: terms that vanish, and the cautions.
    cautions : tuple of str
        What bears on results: the error that truncated modes bring, redundant contacts.  A solution's ``stats.notes``
        hold them, too.
    order : tuple of str
        Order of the degrees of freedom with the smallest bandwidth found.
    bandwidth : int
        Half-bandwidth of the structure in that order (0: diagonal).
    storage : str
        "diagonal", "banded" or "dense": what implicit steps keep of the structure.
    tree : tuple of Branch
        Of a mechanism: on what each body hangs, by which joint, and the coordinates that are that joint's own
        (``sol["pin.angle"]``).  Runs keep the coordinates of bodies; see the page on mechanisms.
    loops : tuple of Loop
        Joints that close loops, and the joints along them.
    """

    scene: str
    dofs: tuple[str, ...]
    parts: tuple[str, ...]
    islands: tuple[Island, ...]
    idle: tuple[str, ...] = ()
    counts: dict[str, int]
    left_out: tuple[Omission, ...]
    resting: tuple[Omission, ...] = ()
    notes: tuple[str, ...]
    cautions: tuple[str, ...] = ()
    order: tuple[str, ...]
    bandwidth: int
    storage: str
    tree: tuple[Branch, ...] = ()
    loops: tuple[Loop, ...] = ()

    @property
    def key(self) -> tuple[Any, ...]:
        """What distinguishes the arrays of two plans of one scene."""
        return self.dofs, self.parts

    @facade
    def _repr_html_(self) -> str:
        """Show it in a notebook."""

    def __str__(self) -> str:
        lines = [f"plan of {self.scene!r}"]
        width = max(len(name) for name in self.counts)
        for name, count in self.counts.items():
            if count or name in _ALWAYS:  # of a mechanism they are coordinates, more than what is free
                label = "coordinates" if name == "degrees of freedom" and self.counts.get("joints") else name
                lines.append(f"  {label:<{width}}  {count}")
        lines.append(f"  {'storage':<{width}}  {self.storage} (half-bandwidth {self.bandwidth})")
        if len(self.islands) > 1:
            lines.append("islands (each run on its own)")
            lines += _some([f"  {island}" for island in self.islands])
        if self.tree:
            lines.append("tree of bodies and joints")
            lines += _some([f"  {branch}" for branch in self.tree])
        if self.loops:
            lines.append("joints that close loops")
            lines += _some([f"  {loop}" for loop in self.loops])
        if self.resting:
            lines.append("not run")
            lines += _some([f"  {item}" for item in self.resting])
        lines.append("left out" if self.left_out else "left out: nothing")
        lines += _some([f"  {item}" for item in self.left_out])
        if self.notes:
            lines.append("notes")
            lines += _some([f"  {note}" for note in self.notes])
        return "\n".join(lines)


_ALWAYS = ("degrees of freedom", "contacts")
#: Lines of one kind that are printed.
MANY = 12


def _some(lines: list[str]) -> list[str]:
    """The lines, or the first of them and how many more."""
    return lines if len(lines) <= MANY else [*lines[: MANY - 1], f"  ... and {len(lines) - MANY + 1} more"]


def short_list(names: tuple[str, ...], most: int = 6) -> str:
    """Names in a line, the first few and how many more."""
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
