"""Materials, antennas, the transmitter, and their lookup tables for the kernels."""
