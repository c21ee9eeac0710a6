"""The field tables and the power threshold of a trace."""

from collections.abc import Sequence

from raytrace.config import TraceConfig
from raytrace.radio.antennas import Antenna
from raytrace.radio.materials import Slab
from raytrace.radio.tables import field_tables
from raytrace.radio.transmitter import Transmitter
from raytrace.solver.path_class import Evaluation


def evaluation_of(
    slabs: Sequence[Slab],
    transmitter: Transmitter,
    config: TraceConfig,
    receive_antenna: Antenna | None = None,
) -> Evaluation:
    """Tabulate materials and antennas at the transmitter's frequency.

    Parameters
    ----------
    slabs
        Materials and thicknesses by number, as in `Scene.slabs`.
    transmitter
        Its frequency, power and antenna; the position is not used.
    config
        Whether paths go through walls, and `min_power_dbm`.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.
    """
    through_walls = config.max_transmissions != 0
    tables = field_tables(
        transmitter, slabs, receive_antenna=receive_antenna, through_walls=through_walls
    )
    return Evaluation(tables, 10.0 ** ((config.min_power_dbm - transmitter.power_dbm) / 10.0))
