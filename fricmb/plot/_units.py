"""What stands in brackets on an axis."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Units:
    """Names of the units that a scene's numbers are in; by default the dimensions themselves.

    ``Units(time="s", length="m", force="N")`` labels a velocity with "m/s" and an energy with "N m".
    """

    time: str = "time"
    length: str = "length"
    force: str = "force"

    @property
    def velocity(self) -> str:
        """Unit of velocity."""
        return "1" if self.dimensionless else f"{self.length}/{self.time}"

    @property
    def angular_velocity(self) -> str:
        """Unit of angular velocity."""
        return "1" if self.dimensionless else f"rad/{self.time}"

    @property
    def energy(self) -> str:
        """Unit of energy."""
        return "1" if self.dimensionless else f"{self.force} {self.length}"

    @property
    def dimensionless(self) -> bool:
        """Whether all three are plain numbers."""
        return self.time == self.length == self.force == "1"


#: Labels for a scene whose units are not known.
SCENE_UNITS = Units()
