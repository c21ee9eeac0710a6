"""Tables of the decomposition, of the interpretations and of the proof by parity."""

from __future__ import annotations

from collections.abc import Sequence

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.paper.data import AGENTS, CONFIGURATIONS, Configuration
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.studies.readings.empty_floor import FLOORS
from rssnav.experiments.studies.readings.interpretations import (
    SOURCE_SHIFTS_M,
    STARTS,
    STATED_GOAL,
)
from rssnav.experiments.studies.readings.lengths import (
    CHANCE_RANGE_M,
    DIAGONALS,
    PRINTED_DIAGONAL,
    chance_of_a_solution,
    printed_counts,
    supposed_counts,
)
from rssnav.experiments.studies.readings.outcome import Outcome
from rssnav.experiments.tables import Column, Table


def diagonals() -> Table:
    """Make a row per length of a diagonal step: how many printed lengths it explains."""
    rows: list[tuple[str | int | float, ...]] = []
    for name, diagonal in DIAGONALS.items():
        solved = [key for key, found in printed_counts(diagonal).items() if found]
        explained = [sum(key.speed == speed for key in solved) for speed in SPEEDS]
        chances = [chance_of_a_solution(speed, diagonal) for speed in SPEEDS]
        rows.append((name, len(solved), *explained, *chances))
    low, high = CHANCE_RANGE_M
    return Table(
        "readings_diagonals",
        "Printed lengths that a diagonal step explains",
        "A length is explained if whole numbers of straight and diagonal steps give it to the "
        f"centimetre. Chance: fraction of all lengths of {low:g} to {high:g} m that are explained.",
        (
            Column("diagonal", "Diagonal step"),
            Column("explained", "Explained, of 12"),
            *(Column(f"explained_{v}mps", f"at {v} m/s, of 4") for v in SPEEDS),
            *(Column(f"chance_{v}mps", f"Chance at {v} m/s", 2) for v in SPEEDS),
        ),
        tuple(rows),
    )


def lengths(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per printed length: its steps, and the fewest that the empty floor allows."""
    by_diagonal = {name: printed_counts(DIAGONALS[name]) for name in ("√2", PRINTED_DIAGONAL)}
    supposed = supposed_counts()
    ours = next(o for o in outcomes if _is_ours(o))
    return Table(
        "readings_lengths",
        "The printed lengths as numbers of steps",
        "Steps, and diagonal ones among them. Used: the solution with a diagonal of "
        f"{PRINTED_DIAGONAL}, or the nearest one. Fewest: steps of any flight on the empty floor, "
        f"from the cell centre, to {STATED_GOAL}.",
        (
            Column("configuration", "Configuration"),
            Column("length_m", "Printed [m]", 2),
            *(Column(f"counts_{name}", f"Diagonal {name}") for name in by_diagonal),
            Column("steps", "Steps used"),
            Column("diagonal_steps", "Diagonal"),
            Column("least_steps", "Fewest"),
        ),
        tuple(
            (
                key.label,
                PATH_LENGTH_M[key],
                *("; ".join(map(str, found[key])) or "none" for found in by_diagonal.values()),
                supposed[key].steps,
                supposed[key].diagonal,
                ours.least_steps[key],
            )
            for key in CONFIGURATIONS
        ),
    )


def _is_ours(outcome: Outcome) -> bool:
    """Whether an outcome is that of our interpretation of start, source and goal."""
    geometry = outcome.geometry
    ours = (0.5, (0.0, 0.0), STATED_GOAL)
    return (geometry.start_offset_m, geometry.source_offset_m, geometry.goal) == ours


def parities() -> Table:
    """Make a row per scenario and speed: whether the goal can hold the ends of both flights.

    A straight step changes the parity of the sum of row and column, counted in steps; a diagonal
    one does not. Flights from one start whose numbers of straight steps differ in parity end at
    different receivers, at least one step apart. An open disc holds two such receivers only if its
    diameter is greater.
    """
    counts = supposed_counts()
    rows: list[tuple[str | int | float, ...]] = []
    for scenario in FLOORS:
        for speed in SPEEDS:
            straight = [counts[Configuration(scenario, a, speed)].straight for a in AGENTS]
            apart = float(speed) if (straight[0] - straight[1]) % 2 else 0.0
            possible = apart < 2 * STATED_GOAL.radius_m
            rows.append((scenario, speed, *straight, apart, "yes" if possible else "no"))
    return Table(
        "readings_parity",
        "Both flights of a scenario and speed, if all their steps are counted",
        "A straight step changes the parity of row + column, a diagonal one does not; so flights "
        "whose numbers of straight steps differ in parity end at least one step apart. "
        f"In a goal of {STATED_GOAL} two receivers are less than {2 * STATED_GOAL.radius_m:g} m "
        "apart, wherever grid and source are.",
        (
            Column("scenario", "Scenario"),
            Column("speed", "Speed [m/s]"),
            Column("straight_rss", "Straight steps, RSS-based"),
            Column("straight_location", "location-based"),
            Column("apart_m", "End points apart, at least [m]", 1),
            Column("possible", "Possible"),
        ),
        tuple(rows),
    )


def interpretations(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per interpretation: which of the twelve flights exist on the empty floor."""
    shifts = dict(zip(SOURCE_SHIFTS_M, ("as stated", "+0.5 m", "−0.5 m"), strict=True))
    return Table(
        "readings",
        "Interpretations and the flights they allow",
        "Whether a flight with the numbers of steps of each printed length exists on the empty "
        "floor (exact search). 1: yes, 0: no.",
        (
            Column("start", "Receivers"),
            Column("source", "Source"),
            Column("goal", "Goal"),
            Column("count", "Counted"),
            *(Column(key.name, _short(key)) for key in CONFIGURATIONS),
            Column("possible", "Of 12"),
        ),
        tuple(
            (
                STARTS[outcome.geometry.start_offset_m],
                shifts[outcome.geometry.source_offset_m[0]],
                str(outcome.geometry.goal),
                str(count),
                *map(int, outcome.possible[count]),
                outcome.n_possible(count),
            )
            for outcome in outcomes
            for count in Count
        ),
    )


def _short(key: Configuration) -> str:
    """Return the name of a configuration in a narrow column."""
    return f"S{key.scenario} {'RSS' if key.agent == 'rss' else 'loc'} {key.speed}"


def source_offsets(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per position of the source between receivers on whole metres."""
    return Table(
        "readings_offsets",
        "Positions of the source against the receivers",
        f"Flights of the twelve that exist on the empty floor, with a goal of {STATED_GOAL}.",
        (
            Column("dx_m", "Shift x [m]", 3),
            Column("dy_m", "Shift y [m]", 3),
            *(Column(count.name.lower(), f"Of 12, {count}") for count in Count),
        ),
        tuple(
            (
                *outcome.geometry.source_offset_m,
                *(outcome.n_possible(count) for count in Count),
            )
            for outcome in outcomes
        ),
    )
