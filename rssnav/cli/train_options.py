"""The options of ``rssnav train``."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

EPISODES = 1000
EPISODES_TO_CONVERGE = 20_000
GOAL = "Goal"
LEARNING = "Learning"
STATES = "States of the RSS agent"


class AgentName(StrEnum):
    """Agents that can be trained."""

    RSS = "rss"
    LOCATION = "location"


MapFile = Annotated[
    Path,
    typer.Option("--map", metavar="FILE", help="The plan's radio map (rssnav map)."),
]
AgentOption = Annotated[AgentName, typer.Option(help="What the agent senses.")]
Speed = Annotated[
    int, typer.Option(metavar="V", min=1, max=1000, help="Cells per step along an axis.")
]
Episodes = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        max=10_000_000,
        help="Episodes per run; the maximum with --until-converged.",
        show_default=f"{EPISODES}, or {EPISODES_TO_CONVERGE} with --until-converged",
    ),
]
UntilConverged = Annotated[
    bool,
    typer.Option(
        "--until-converged",
        help="Stop a run after three consecutive episodes with the same flight.",
    ),
]
ResultFile = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE",
        help="Save the result to FILE (HDF5). Runs that it already holds are not repeated.",
        show_default=False,
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Train from scratch, and overwrite FILE.")]
Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="DB",
        min=0.0,
        max=1000.0,
        help="RSS readings within this distance of a known state belong to it.",
        show_default="each RSS value is a state",
        rich_help_panel=STATES,
    ),
]
Interval = Annotated[
    float | None,
    typer.Option(
        metavar="DB",
        min=0.001,
        max=1000.0,
        help="Use RSS intervals of this width as states.",
        show_default="each RSS value is a state",
        rich_help_panel=STATES,
    ),
]
FluctuationDb = Annotated[
    float,
    typer.Option(
        metavar="DB",
        min=0.0,
        max=100.0,
        help="Standard deviation of the RSS readings; needs --tolerance or --interval.",
        rich_help_panel=STATES,
    ),
]
Sensitivity = Annotated[
    float,
    typer.Option(
        metavar="DBM",
        min=-1000.0,
        max=1000.0,
        help='Sensitivity of the receiver: at or below it, the RSS agent reads "no signal".',
        rich_help_panel=STATES,
    ),
]
GoalRss = Annotated[
    float,
    typer.Option(
        metavar="DBM",
        min=-1000.0,
        max=1000.0,
        help="The RSS agent has found the source above this RSS.",
        rich_help_panel=GOAL,
    ),
]
GoalDistance = Annotated[
    float,
    typer.Option(
        metavar="M",
        min=0.0,
        max=10_000.0,
        help="The location agent has found the source within this distance in metres.",
        rich_help_panel=GOAL,
    ),
]
Gamma = Annotated[
    float,
    typer.Option(metavar="G", min=0.0, max=1.0, help="Discount factor.", rich_help_panel=LEARNING),
]
Eta = Annotated[
    float,
    typer.Option(
        metavar="E",
        min=0.0,
        max=1.0,
        help="Decay of epsilon and alpha per step.",
        rich_help_panel=LEARNING,
    ),
]
InitialQ = Annotated[
    float,
    typer.Option(
        metavar="Q", min=-1e9, max=1e9, help="Initial value of Q.", rich_help_panel=LEARNING
    ),
]
MaxSteps = Annotated[
    int,
    typer.Option(
        metavar="N",
        min=1,
        max=10**9,
        help="Steps after which an episode is truncated.",
        rich_help_panel=LEARNING,
    ),
]
