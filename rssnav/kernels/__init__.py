"""Compiled loops of the learning half: arrays and scalars in, arrays filled, nothing checked.

``xoshiro``
    The generator each run draws from.
``common``
    The NamedTuples the loops share, and Algorithm 1's pieces: epsilon-greedy choice, decay,
    convergence bookkeeping.
``tabular``
    The loop for one Q row per cell, the paper's case.
``sensed``
    The loop for states made from RSS readings: exact values that repeat, tolerance states created
    as readings come, intervals, and readings that fluctuate.
"""
