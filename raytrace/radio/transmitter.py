"""The transmitter: position, power, frequency, antenna."""

from dataclasses import dataclass, field

from raytrace.constants import SPEED_OF_LIGHT
from raytrace.radio.antennas import Antenna, HalfWaveDipole


@dataclass(frozen=True)
class Transmitter:
    """A point source of radio waves.

    Attributes
    ----------
    position
        (x, y, z) [m]; z above the floor.
    power_dbm
        Power fed to the antenna [dBm].
    frequency_hz
        Carrier frequency [Hz].
    antenna
        Its pattern, peak gain included.

    Raises
    ------
    ValueError
        For a number that is not finite, or a frequency that is not positive.
    """

    position: tuple[float, float, float]
    power_dbm: float = 25.0
    frequency_hz: float = 2.4e9
    antenna: Antenna = field(default_factory=HalfWaveDipole)

    def __post_init__(self) -> None:
        """Check the numbers; raise ValueError for one that is not finite."""
        position = tuple(float(c) for c in self.position)
        if len(position) != 3 or not all(abs(c) < float("inf") for c in position):
            raise ValueError(f"position = {self.position}: expected three finite numbers [m]")
        object.__setattr__(self, "position", position)
        if not abs(self.power_dbm) < float("inf"):
            raise ValueError(f"power_dbm = {self.power_dbm}: expected a finite number")
        if not 0.0 < self.frequency_hz < float("inf"):
            raise ValueError(f"frequency_hz = {self.frequency_hz}: expected a positive number")
        for name in ("power_dbm", "frequency_hz"):
            object.__setattr__(self, name, float(getattr(self, name)))

    @property
    def wavelength_m(self) -> float:
        """Free-space wavelength [m]."""
        return SPEED_OF_LIGHT / self.frequency_hz
