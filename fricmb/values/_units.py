"""Names of the units that a scene's numbers are in."""

from __future__ import annotations

from dataclasses import dataclass, fields

from fricmb.errors import SceneError, shown

#: Units that everybody knows, by what they measure.
_KNOWN = {
    "time": ("s", "ms", "us", "µs", "min", "h"),
    "length": ("m", "mm", "cm", "km", "um", "µm", "in", "ft"),
    "force": ("N", "kN", "MN", "mN", "lbf", "kgf"),
    "mass": ("kg", "g", "t", "mg", "lb"),
}
#: A thousand times the first is the second: what the reciprocal of a unit of time is called.
_FREQUENCIES = {"s": "Hz", "ms": "kHz", "us": "MHz", "µs": "MHz", "min": "1/min", "h": "1/h"}


@dataclass(frozen=True)
class Units:
    """Names of the units that a scene's numbers are in: for labels, nothing is converted.

    ``Units("s", "m", "N")`` labels a velocity with "m/s", an energy with "N m" and a frequency with "Hz".  Given to a
    scene, they go with it into its solutions, files and pictures.  "1" for all three: numbers without dimension.

    Parameters
    ----------
    time, length, force : str
        Default: the dimensions themselves.

    Examples
    --------
    >>> import fricmb as fm
    >>> units = fm.Units("s", "mm", "N")
    >>> units.velocity, units.frequency
    ('mm/s', 'Hz')
    """

    time: str = "time"
    length: str = "length"
    force: str = "force"

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not isinstance(value, str) or not value:
                raise SceneError(f"Units: {field.name} must be a non-empty string, got {shown(value)}")
            meant = next((kind for kind, names in _KNOWN.items() if value in names), field.name)
            if meant != field.name:
                raise SceneError(
                    f"Units: {field.name} must be a unit of {field.name}, got {shown(value)}, one of {meant};"
                    ' the order is time, length, force, as in Units("s", "m", "N")'
                )

    @property
    def velocity(self) -> str:
        """Unit of velocity."""
        return "1" if self.dimensionless else f"{self.length}/{self.time}"

    @property
    def angular_velocity(self) -> str:
        """Unit of angular velocity, and of angular frequency."""
        return "1" if self.dimensionless else f"rad/{self.time}"

    @property
    def angular_frequency(self) -> str:
        """Unit of angular frequency."""
        return self.angular_velocity

    @property
    def frequency(self) -> str:
        """Unit of frequency: turns for each unit of time."""
        return "1" if self.dimensionless else _FREQUENCIES.get(self.time, f"1/{self.time}")

    @property
    def rate(self) -> str:
        """Unit of growth rates."""
        return "1" if self.dimensionless else f"1/{self.time}"

    @property
    def energy(self) -> str:
        """Unit of energy."""
        return "1" if self.dimensionless else f"{self.force} {self.length}"

    @property
    def torque(self) -> str:
        """Unit of torque."""
        return self.energy

    @property
    def dimensionless(self) -> bool:
        """Whether all three are plain numbers."""
        return self.time == self.length == self.force == "1"


#: Of a scene that names none: labels say the dimensions.
DIMENSIONS = Units()
#: Numbers without dimension.
DIMENSIONLESS = Units("1", "1", "1")
#: Second, metre, newton.
SI = Units("s", "m", "N")
