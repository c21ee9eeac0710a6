"""Compiled loops of the learning half: arrays and scalars in, arrays filled, nothing checked.

``stepping``
    One second of a flight: modes of the world, readings, rewards, ends of episodes.
``learning``
    Algorithm 1, SARSA and Double Q-learning: the loop of episodes.
``reading_states``
    Rows of Q made from what an agent observes: exact values that repeat, tolerance states created
    as readings come, intervals, readings that fluctuate, headings, doors seen.

Searchers, which do not learn from flight to flight:

``searchers``
    Random walk, RSS ascent.
``particle_filter``
    Flights by a belief about the transmitter's position.

Shared:

``common``
    Arguments of the loops, decay, log of episodes, convergence.
``xoshiro``
    The random number generator of each run.
``compiling``
    How the loops are compiled, and where numba caches the machine code.
"""
