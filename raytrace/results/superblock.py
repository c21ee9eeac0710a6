"""The checksum of the first 48 bytes of an HDF5 file, its superblock.

HDF5 marks in them that a file is open. Before version 2.0 the image of an open file comes without
this mark, but with the checksum of a superblock that has it: it cannot be opened. The checksum is
Jenkins' lookup3 (HDF5 file format specification, version 3.0, sections II.A and "Checksums").
"""

import struct

N_BYTES, N_WORDS = 44, 11
"""Of a superblock of version 3 with offsets of 8 bytes, before its checksum."""

_MASK = 0xFFFFFFFF
_SEED = 0xDEADBEEF

_MIX = ((0, 2, 4, 1), (1, 0, 6, 2), (2, 1, 8, 0), (0, 2, 16, 1), (1, 0, 19, 2), (2, 1, 4, 0))
"""Steps x = (x - y) ^ rotated(y), y += z of numbers (a, b, c): x, y, bits, z."""

_FINAL = ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24))
"""Steps x = (x ^ y) - rotated(y): x, y, bits."""


def with_checksum(image: bytes) -> bytes:
    """Return the image of an HDF5 file, 1.10 or newer, with the checksum that it needs."""
    checksum = lookup3(struct.unpack_from(f"<{N_WORDS}I", image))
    return image[:N_BYTES] + struct.pack("<I", checksum) + image[N_BYTES + 4 :]


def lookup3(words: tuple[int, ...]) -> int:
    """Hash of at least one 32-bit word."""
    state = [(_SEED + 4 * len(words)) & _MASK] * 3
    for begin in range(0, len(words), 3):
        for k, word in enumerate(words[begin : begin + 3]):
            state[k] = (state[k] + word) & _MASK
        if begin + 3 < len(words):
            for x, y, bits, z in _MIX:
                state[x] = ((state[x] - state[y]) & _MASK) ^ _rotated(state[y], bits)
                state[y] = (state[y] + state[z]) & _MASK
    for x, y, bits in _FINAL:
        state[x] = ((state[x] ^ state[y]) - _rotated(state[y], bits)) & _MASK
    return state[2]


def _rotated(word: int, bits: int) -> int:
    return ((word << bits) | (word >> (32 - bits))) & _MASK
