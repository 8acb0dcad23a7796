"""What will be built from a scene, and what is left out and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Omission:
    """Something that is not built, and why; ``names`` of dofs and parts."""

    what: str
    why: str
    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.what}: {self.why}"


@dataclass(frozen=True, kw_only=True)
class Island:
    """Degrees of freedom and parts that can influence each other, and nothing else."""

    dofs: tuple[str, ...]
    parts: tuple[str, ...]

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
        Independent groups among them.
    counts : dict of str to int
        "bodies", "driven bodies", "degrees of freedom", "linear elements", "nonlinear elements", "matrix elements",
        "forces of time", "contacts", "contact rows", "law states", "islands".
    left_out : tuple of Omission
        What is not built, and why.
    notes : tuple of str
        What is worth knowing beside: degrees of freedom that rest, terms that vanish.
    order : tuple of str
        Order of the degrees of freedom with the smallest bandwidth found.
    bandwidth : int
        Half-bandwidth of the structure in that order (0: diagonal).
    storage : str
        "diagonal", "banded", "sparse" or "dense": the fitting form of the constant matrices.
    """

    scene: str
    dofs: tuple[str, ...]
    parts: tuple[str, ...]
    islands: tuple[Island, ...]
    counts: dict[str, int]
    left_out: tuple[Omission, ...]
    notes: tuple[str, ...]
    order: tuple[str, ...]
    bandwidth: int
    storage: str

    @property
    def key(self) -> tuple[Any, ...]:
        """What distinguishes the arrays of two plans of one scene."""
        return self.dofs, self.parts

    def _repr_html_(self) -> str:
        from fricmb.plot._html import plan_html

        return plan_html(self)

    def __str__(self) -> str:
        lines = [f"plan of {self.scene!r}"]
        width = max(len(name) for name in self.counts)
        lines += [f"  {name:<{width}}  {count}" for name, count in self.counts.items() if count or name in _ALWAYS]
        lines.append(f"  {'storage':<{width}}  {self.storage} (half-bandwidth {self.bandwidth})")
        if len(self.islands) > 1:
            lines.append("islands (solved on their own)")
            lines += [f"  {island}" for island in self.islands]
        lines.append("left out" if self.left_out else "left out: nothing")
        lines += [f"  {item}" for item in self.left_out]
        if self.notes:
            lines.append("notes")
            lines += [f"  {note}" for note in self.notes]
        return "\n".join(lines)


_ALWAYS = ("degrees of freedom", "contacts")


def short_list(names: tuple[str, ...], most: int = 6) -> str:
    """Names in a line, the first few and how many more."""
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
