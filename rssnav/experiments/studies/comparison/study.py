"""Oracles, learners and searchers side by side, in the same worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rssnav.experiments.paper.data import AGENTS
from rssnav.experiments.paper.scenarios import PLANS, SPEEDS
from rssnav.experiments.studies.comparison.methods import (
    CONTENDERS,
    NOISE,
    Contender,
    Performance,
)
from rssnav.experiments.studies.study import Conditions, Study
from rssnav.experiments.tables import Cell, Column, Table, mean_cell, sd_cell
from rssnav.learning_parameters import QLearning
from rssnav.optimal_flights import shortest_path


@dataclass(frozen=True)
class Entry:
    """A contender in one scenario at one speed."""

    scenario: int
    speed: int
    contender: Contender


@dataclass(frozen=True, eq=False)
class Outcome:
    """Performance of a method, and the length [m] of the shortest flight in its world."""

    entry: Entry
    performance: Performance
    shortest_m: float


def entries() -> tuple[Entry, ...]:
    """List every contender in both scenarios at all speeds."""
    return tuple(
        Entry(scenario, speed, contender)
        for scenario in range(1, 1 + len(PLANS))
        for speed in SPEEDS
        for contender in CONTENDERS
    )


def measure(entry: Entry, conditions: Conditions) -> list[Outcome]:
    """Fly the methods of an entry.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C while training.
    """
    world = conditions.worlds[entry.scenario, entry.speed]
    terminal = AGENTS["location"].decision_process(world, QLearning()).terminal
    shortest_m = shortest_path(world, terminal, "metres").length_m
    return [
        Outcome(entry, performance, shortest_m)
        for performance in entry.contender.fly(world, conditions)
    ]


def comparison_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per scenario, speed and method."""
    return Table(
        "comparison",
        "Oracles, learners and searchers",
        "Success: fraction of runs whose final flight (learners: the greedy one after training; "
        "searchers: the only one) reaches the source. Steps, length and regret are over those. "
        "Detour: length over the shortest possible. Regret: optimal discounted return minus the "
        f"flight's. In the σ = {NOISE.sigma_db:g} dB rows RSS readings fluctuate; a false alarm is "
        "a reading above −21 dBm elsewhere, which ends the flight.",
        (
            Column("scenario", "Scenario"),
            Column("speed_mps", "Speed [m/s]"),
            Column("kind", "Kind"),
            Column("method", "Method"),
            Column("knows", "Uses"),
            Column("sigma_db", "σ [dB]"),
            Column("runs", "Runs"),
            Column("converged", "Converge"),
            Column("training_steps", "Training steps"),
            Column("success", "Success", 2),
            Column("false_alarms", "False alarms", 2),
            Column("mean_steps", "Steps", 1),
            Column("sd_steps", "± sd", 1),
            Column("mean_m", "Length [m]", 1),
            Column("sd_m", "± sd [m]", 1),
            Column("detour", "Detour", 3),
            Column("mean_regret", "Regret", 2),
            Column("sd_regret", "± sd", 2),
        ),
        tuple(_row(outcome) for outcome in outcomes),
    )


def _row(outcome: Outcome) -> tuple[Cell, ...]:
    method, lengths_m = outcome.performance, outcome.performance.length_m
    return (
        outcome.entry.scenario,
        outcome.entry.speed,
        method.kind,
        method.name,
        method.knows,
        method.sigma_db,
        method.runs,
        method.converged,
        mean_cell(method.training_steps),
        lengths_m.size / method.runs,
        method.false_alarms,
        mean_cell(method.steps),
        sd_cell(method.steps),
        mean_cell(lengths_m),
        sd_cell(lengths_m),
        float(lengths_m.mean()) / outcome.shortest_m if lengths_m.size else None,
        mean_cell(method.regret),
        sd_cell(method.regret),
    )


STUDY = Study(
    name="comparison",
    runs=50,
    quick_runs=3,
    pieces=entries(),
    measure=measure,
    tables=lambda outcomes: (comparison_table(outcomes),),
    figures=lambda _: {},
)
