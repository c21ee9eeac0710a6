"""What the paper does not specify, and our interpretation of each point."""

from __future__ import annotations

from dataclasses import dataclass

from rssnav.experiments.tables import Column, Table


@dataclass(frozen=True)
class Interpretation:
    """A choice that the paper does not specify.

    Attributes
    ----------
    name : str
        The choice.
    ours : str
        What is done here.
    reason : str
        Why it is done so.
    """

    name: str
    ours: str
    reason: str


INTERPRETATIONS: tuple[Interpretation, ...] = (
    Interpretation(
        "Floor plans",
        "Reconstructed; only sizes, source, start, wall and door heights are the paper's.",
        "The plans were never published. `rssnav experiments plans` searched for plans in which "
        "flights of the paper's lengths exist, and chose those that agree best with its table and "
        "two of its claims: agreement with these is a fit.",
    ),
    Interpretation(
        "Position of the grid",
        "Receivers are at the cell centres (i + 0.5, j + 0.5) m; the start is the cell with the "
        "paper's index; the source is at the paper's coordinates.",
        "Then exactly the twelve cells nearer than 2 m to the source read more than −21 dBm, and "
        "the source can be reached at 4 m/s in both scenarios.",
    ),
    Interpretation(
        "RSS of a cell",
        "Sum of the powers of all paths; their phases are ignored.",
        "The −21 dBm rule needs it: with phases, fading hides most of the twelve cells.",
    ),
    Interpretation(
        "Transmission through walls",
        "None.",
        "The paper lists six reflections and one diffraction, and nothing else.",
    ),
    Interpretation(
        "Actions that the maximum is taken over",
        "Those possible in the state, for the greedy action and for max Q(s', a').",
        "With actions that would crash kept at their initial value, the agent is trapped next "
        "to walls.",
    ),
    Interpretation(
        "Initial Q",
        "100 for every state and action.",
        "Not stated. With 0 some agents are trapped in cycles of positive reward; 100 is about "
        "the discounted value of the goal at these distances.",
    ),
    Interpretation(
        "Goal reward",
        "1000 is added to the last step's reward.",
        "The paper says that the UAV gets a reward of 1000, not that it replaces the step's own.",
    ),
    Interpretation(
        "Decay of ε and α",
        "Before every step, until they fall below their minimum.",
        "Algorithm 1 as printed; the text says per episode.",
    ),
    Interpretation(
        "Ties between greedy actions",
        "The first action, counter-clockwise from east.",
        "Not stated.",
    ),
    Interpretation(
        "Step limit of an episode",
        "20 000 steps; an episode that reaches it is truncated, not terminated, so it bootstraps.",
        "Not stated.",
    ),
    Interpretation(
        "Length of the training",
        "Until convergence, at least 1000 and at most 20 000 episodes; the final trajectory is the "
        "greedy one after that.",
        "The paper shows 1000 episodes, but three identical flights in a row need ε near its "
        "minimum.",
    ),
    Interpretation(
        "Convergence time",
        "Reported as episodes, as simulated flight time (1 s a step) and as CPU time.",
        "The paper does not say which.",
    ),
    Interpretation(
        "Length of a trajectory",
        "The last step is left out; the table also has the lengths with all steps.",
        "Flights of all twelve printed lengths exist only if one step of each is left out.",
    ),
    Interpretation(
        "Crash check",
        "A step is impossible when its straight segment touches a wall or leaves the building.",
        "The paper checks the next position; a diagonal step could then cut a corner.",
    ),
)


def interpretations() -> Table:
    """Make a row per interpretation."""
    return Table(
        "readings",  # the name of its file
        "Interpretation",
        "What the paper does not specify, and what is done here.",
        (
            Column("name", "Not specified"),
            Column("ours", "Interpretation"),
            Column("reason", "Reason"),
        ),
        tuple((each.name, each.ours, each.reason) for each in INTERPRETATIONS),
    )
