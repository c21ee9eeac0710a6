"""Compiled loops of the learning half: arrays and scalars in, arrays filled, nothing checked.

Learning rules, one loop each:

``q_learning``
    Algorithm 1 with one row of Q per state, the paper's case.
``q_learning_from_readings``
    Algorithm 1 with discrete states made from RSS readings: exact values that repeat, tolerance
    states created as readings come, intervals, and readings that fluctuate.
``temporal_difference``
    Q-learning, SARSA and Double Q-learning.

Searchers, which do not learn from flight to flight:

``searchers``
    Random walk, RSS ascent.
``particle_filter``
    Flights by a belief about the transmitter's position.

Shared:

``common``
    Arguments of the loops, decay, log of episodes, convergence.
``rss_fluctuation``
    What a receiver reads in a cell.
``xoshiro``
    The random number generator of each run.
``compiling``
    How the loops are compiled, and where numba caches the machine code.
"""
