"""What the paper leaves open, and how each point is read here."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.tables import Column, Table
from rssnav.result_file import agent_parameters


@dataclass(frozen=True)
class Reading:
    """A choice that the paper does not make.

    Attributes
    ----------
    name : str
        What is open.
    ours : str
        What is done here.
    reason : str
        Why.
    """

    name: str
    ours: str
    reason: str


READINGS: tuple[Reading, ...] = (
    Reading(
        "Floor plans",
        "Reconstructed; only sizes, source, start, wall and door heights are the paper's.",
        "The plans were never published. They were chosen so that the source can be reached at all "
        "speeds, every cell has a path, and flights come out near the paper's lengths: agreement "
        "with its table is partly a fit.",
    ),
    Reading(
        "Where the grid lies",
        "Receivers at the cell centres (i + 0.5, j + 0.5) m; the start is the cell with the "
        "paper's index; the source at its coordinates.",
        "Then exactly the twelve cells nearer than 2 m to the source read more than −21 dBm, and "
        "the source can be reached at 4 m/s in both scenarios.",
    ),
    Reading(
        "How a cell's power is formed",
        "Sum of the powers of all paths; their phases are ignored.",
        "The −21 dBm rule needs it: with phases, fading hides most of the twelve cells.",
    ),
    Reading(
        "Transmission through walls",
        "None.",
        "The paper lists six reflections and one diffraction, and nothing else.",
    ),
    Reading(
        "Actions that the maximum runs over",
        "Those possible in the state, for the greedy choice and for max Q(s', a').",
        "With actions that would crash kept at their initial value, the agent is trapped beside "
        "walls.",
    ),
    Reading(
        "Initial Q",
        "100 for every state and action.",
        "Not stated. With 0 some agents are caught by cycles of positive reward; 100 is about "
        "the discounted worth of the goal at these distances.",
    ),
    Reading(
        "Reward at the goal",
        "1000 is added to the last step's reward.",
        "The paper says that the UAV gets a reward of 1000, not that it replaces the step's own.",
    ),
    Reading(
        "Decay of epsilon and alpha",
        "Before every step, while not below their minimum.",
        "Algorithm 1 as printed; the text says with episodes.",
    ),
    Reading(
        "Ties between greedy actions",
        "The first action, counter-clockwise from east.",
        "Not stated.",
    ),
    Reading(
        "Cap on an episode",
        "20 000 steps; a capped episode is truncated, not terminated, so it bootstraps.",
        "Not stated.",
    ),
    Reading(
        "How long training lasts",
        "Until convergence, at least 1000 and at most 20 000 episodes; the final trajectory is the "
        "greedy one after that.",
        "The paper shows 1000 episodes, but three identical flights in a row need epsilon near its "
        "minimum.",
    ),
    Reading(
        "Convergence time",
        "Reported as episodes, as simulated flight time (1 s a step) and as CPU time.",
        "The paper does not say which.",
    ),
    Reading(
        "Crash check",
        "A step is impossible when its straight segment touches a wall or leaves the building.",
        "The paper checks the next position; a diagonal step could then cut a corner.",
    ),
)


def readings() -> Table:
    """Make a row per reading."""
    return Table(
        "readings",
        "Readings",
        "What the paper leaves open, and what is done here.",
        (
            Column("name", "Left open"),
            Column("ours", "Reading here"),
            Column("reason", "Reason"),
        ),
        tuple((reading.name, reading.ours, reading.reason) for reading in READINGS),
    )


def parameters(data: PaperData) -> Table:
    """Make a row per parameter of maps, learning and schedule."""
    result = next(iter(data.results.values()))
    radio_map = next(iter(data.scenarios.values())).radio_map
    groups: dict[str, dict[str, object]] = {
        "trace": dataclasses.asdict(radio_map.config),
        "transmitter": {
            "power_dbm": radio_map.transmitter.power_dbm,
            "frequency_hz": radio_map.transmitter.frequency_hz,
        },
        "grid": {
            "cell_size_m": radio_map.grid.cell_size_m,
            "height_m": radio_map.grid.height_m,
        },
        "learning": dataclasses.asdict(result.learning),
        "schedule": dataclasses.asdict(result.schedule),
    }
    for each in data.results.values():
        groups[f"{each.agent.name} agent"] = agent_parameters(each.agent)
    rows = [(group, name, str(v)) for group, values in groups.items() for name, v in values.items()]
    return Table(
        "parameters",
        "Parameters",
        "Every parameter of maps and trainings; dB, dBm, Hz, m as in the name.",
        (Column("group", "Of"), Column("name", "Parameter"), Column("value", "Value")),
        tuple(rows),
    )
