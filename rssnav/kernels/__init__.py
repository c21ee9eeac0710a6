"""Compiled loops of the learning half: arrays and scalars in, arrays filled, nothing checked.

``xoshiro``
    The generator each run draws from.
``readings``
    What a receiver reads in a cell.
``common``
    The NamedTuples the loops share, and Algorithm 1's pieces: epsilon-greedy choice, decay,
    convergence bookkeeping.
``tabular``
    The loop for one Q row per cell, the paper's case.
``sensed``
    The loop for states made from RSS readings: exact values that repeat, tolerance states created
    as readings come, intervals, and readings that fluctuate.
``temporal_difference``
    The loop for Q-learning, SARSA and Double Q-learning.
``searching``
    Flights that follow a rule without learning: random walk, RSS ascent.
``particle_filter``
    Flights by a belief about where the source is.
``compiling``
    How all of them are compiled, and where the machine code is kept.
"""
