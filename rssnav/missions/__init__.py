"""What an agent flies in, for what, and what it sees of it: three things, kept apart.

A :class:`~rssnav.missions.mission.Mission` is the world: steps between cells (a
:class:`~rssnav.missions.layout.Layout` for each state of the doors), a radio field for each *mode*
(place of the transmitter, state of the doors), the Markov chain of the modes
(:class:`~rssnav.missions.modes.ModeProcess`), and where flights begin. A
:class:`~rssnav.missions.task.Task` says what a step is worth and when an episode ends. An
:class:`~rssnav.missions.observation.Observation` says what the agent sees: a row of a table or a
vector. A :class:`~rssnav.missions.policy.Policy` acts on observations; learners and searchers are
policies. The paper's agents are one task and observation each (:mod:`rssnav.agents`).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
