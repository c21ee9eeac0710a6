"""Materials, antennas and the transmitter, and the tables the kernels look them up in."""
