"""What an audit found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Check:
    """One thing that was looked at.

    Attributes
    ----------
    name : str
        Such as "equations of motion".
    size : float
        The largest residual, in units of what the tolerance of the run allows there.
    limit : float
        Up to here the check passes.
    t : float
        Where the largest residual is; nan where nothing was to be looked at.
    part : str
        The degree of freedom, contact or joint that it belongs to.
    count : int
        Residuals that were looked at.
    """

    name: str
    size: float
    limit: float
    t: float
    part: str
    count: int

    @property
    def ok(self) -> bool:
        """Whether the check passes."""
        return self.size <= self.limit

    def __str__(self) -> str:
        where = f" at t = {self.t:.6g} ({self.part})" if self.part else ""
        return f"{self.name}: {self.size:.2g} of {self.limit:g}{where}"


@dataclass(frozen=True, kw_only=True)
class Audit:
    """The verdict on a run; printed, three lines.

    Attributes
    ----------
    checks : tuple of Check
        Those that the scene gives reason for, the worst first.
    rtol : float
        The tolerance that sizes are measured by.
    n_steps, n_looked : int
        Steps of the run, and how many of them were looked at.
    notes : tuple of str
        What could not be looked at.
    """

    checks: tuple[Check, ...]
    rtol: float
    n_steps: int
    n_looked: int
    notes: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every check passes."""
        return all(check.ok for check in self.checks)

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that do not pass, the worst first."""
        return tuple(check for check in self.checks if not check.ok)

    def __getitem__(self, name: str) -> Check:
        """The check of that name; KeyError with those there are."""
        for check in self.checks:
            if check.name == name:
                return check
        raise KeyError(f"no check {name!r}; there are {', '.join(repr(check.name) for check in self.checks)}")

    def table(self) -> str:
        """Every check on a line."""
        return "\n".join(f"{'  ' if check.ok else '! '}{check}" for check in self.checks)

    def __str__(self) -> str:
        passed = sum(check.ok for check in self.checks)
        verdict = "passes" if self.ok else "FAILS"
        looked = f"{self.n_looked} of {self.n_steps} steps, units of rtol = {self.rtol:.0e}"
        first = f"audit {verdict}: {passed} of {len(self.checks)} checks hold ({looked})"
        worst = "; ".join(map(str, (self.failed or self.checks[:1])[:3]))
        second = f"{'worst' if self.ok else 'wrong'}: {worst or 'nothing to look at'}"
        return "\n".join((first, second, "not looked at: " + ("; ".join(self.notes) or "nothing")))
