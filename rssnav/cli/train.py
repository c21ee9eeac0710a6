"""``rssnav train``: train an agent on a radio map."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import typer
from numpy.typing import NDArray

import floorplans
from raytrace import RadioMap
from rssnav import (
    Agent,
    ExactStates,
    Fluctuation,
    GridWorld,
    IntervalStates,
    LocationAgent,
    QLearning,
    ResultFileError,
    RssAgent,
    ToleranceStates,
    TrainingInterrupted,
    TrainingResult,
    shortest_path,
    train,
)
from rssnav.cli.console import note, one_progress, print_json, print_pairs, say
from rssnav.cli.options import Json, Plan, Runs, Seed, Threads, examples
from rssnav.cli.train_options import (
    EPISODES,
    EPISODES_TO_CONVERGE,
    AgentName,
    AgentOption,
    Episodes,
    Eta,
    FluctuationDb,
    Force,
    Gamma,
    GoalDistance,
    GoalRss,
    InitialQ,
    Interval,
    MapFile,
    MaxSteps,
    ResultFile,
    Sensitivity,
    Speed,
    Tolerance,
    UntilConverged,
)
from rssnav.discrete_states import StateRule, heard
from rssnav.interrupts import INTERRUPTS
from rssnav.keeping import lenient, save_or_rescue
from rssnav.maps import Progress, require_map_for
from rssnav.training import Checkpoint


def add_to(parent: typer.Typer) -> None:
    """Add the command ``train``."""
    parent.command(
        "train",
        epilog=examples(
            "rssnav map flat -o flat.h5",
            "rssnav train flat --map flat.h5 --goal-rss -30 --runs 10",
            "rssnav train flat --map flat.h5 --agent location -o location.h5",
        ),
    )(train_agent)


def train_agent(
    plan: Plan,
    map_file: MapFile,
    agent: AgentOption = AgentName.RSS,
    speed: Speed = 1,
    runs: Runs = 100,
    episodes: Episodes = None,
    until_converged: UntilConverged = False,
    seed: Seed = 0,
    output: ResultFile = None,
    force: Force = False,
    tolerance: Tolerance = None,
    interval: Interval = None,
    fluctuation: FluctuationDb = 0.0,
    sensitivity: Sensitivity = RssAgent.sensitivity_dbm,
    goal_rss: GoalRss = RssAgent.terminal_dbm,
    goal_distance: GoalDistance = LocationAgent.terminal_distance_m,
    gamma: Gamma = QLearning.gamma,
    eta: Eta = QLearning.eta,
    initial_q: InitialQ = QLearning.initial_q,
    max_steps: MaxSteps = QLearning.max_steps,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Train an agent to fly from a plan's start to its source, in independent realisations.

    With -o, finished runs are saved every few seconds, so that the same command resumes after
    Ctrl-C or a crash.
    """
    loaded = floorplans.load(plan)
    radio_map = RadioMap.load(map_file)
    require_map_for(loaded, radio_map, map_file)
    world = GridWorld.from_map(loaded, radio_map, speed)
    senses = _Senses(agent, tolerance, interval, fluctuation, sensitivity, goal_rss, goal_distance)
    learning = _learning(gamma=gamma, eta=eta, initial_q=initial_q, max_steps=max_steps)
    job = _Job(
        world,
        senses.agent_in(world),
        {
            "runs": runs,
            "episodes": episodes or (EPISODES_TO_CONVERGE if until_converged else EPISODES),
            "seed": seed,
            "learning": learning,
            "until_converged": until_converged,
        },
        output,
    )
    result = job.run(None if force else job.earlier(), threads)
    summary = _summary(result)
    if as_json:
        print_json({"plan": plan, "map": str(map_file), **summary})
    else:
        _print(summary, output)


def _learning(**parameters: Any) -> QLearning:
    try:
        return QLearning(**parameters)
    except ValueError as error:
        raise typer.BadParameter(f"{error}.") from error


@dataclass(frozen=True)
class _Senses:
    """Options of the agent."""

    agent: AgentName
    tolerance: float | None
    interval: float | None
    fluctuation: float
    sensitivity: float
    goal_rss: float
    goal_distance: float

    def agent_in(self, world: GridWorld) -> Agent:
        """Make the agent; contradictory options are wrong usage."""
        if self.tolerance is not None and self.interval is not None:
            raise typer.BadParameter("use --tolerance or --interval, not both.")
        try:
            if self.agent is AgentName.LOCATION:
                self._refuse_rss_options()
                return LocationAgent(self.goal_distance)
            heard_dbm = heard(world.rss_dbm, self.sensitivity)
            states = _states(heard_dbm, self.tolerance, self.interval)
            fluctuation = Fluctuation(self.fluctuation)
            return RssAgent(states, self.goal_rss, fluctuation, self.sensitivity)
        except ValueError as error:
            raise typer.BadParameter(f"{error}.") from error

    def _refuse_rss_options(self) -> None:
        if self.tolerance is not None or self.interval is not None or self.fluctuation != 0.0:
            raise typer.BadParameter(
                "--tolerance, --interval and --fluctuation apply to the RSS agent only; leave them "
                "out, or use --agent rss."
            )


def _states(
    heard_dbm: NDArray[np.float64], tolerance: float | None, interval: float | None
) -> StateRule:
    if tolerance is not None:
        return ToleranceStates(tolerance)
    if interval is not None:
        low, high = float(np.floor(heard_dbm.min())), float(np.ceil(heard_dbm.max()))
        return IntervalStates.uniform(low, high, interval)
    return ExactStates()


class _Job:
    """A training, and the file that stores its runs."""

    def __init__(
        self, world: GridWorld, agent: Agent, schedule: dict[str, Any], output: Path | None
    ) -> None:
        self._world = world
        self._agent = agent
        self._schedule = schedule
        self._output = output

    def earlier(self) -> TrainingResult | None:
        """Return the finished runs in the file; reject any other file."""
        if self._output is None or not self._output.exists():
            return None
        try:
            found = TrainingResult.load(self._output)
        except ResultFileError as error:
            raise ResultFileError(f"{error}; use --force to overwrite") from error
        note(f"{self._output} holds {found.run_ids.size} of {found.schedule.runs} runs")
        return found

    def run(self, earlier: TrainingResult | None, threads: int | None) -> TrainingResult:
        """Train the missing runs and save them; on Ctrl-C, save the finished ones."""
        stage = f"{self._agent.name} agent, speed {self._world.speed}"
        try:
            with one_progress(stage) as progress:
                result = self._train(earlier, threads, progress)
        except TrainingInterrupted as interrupt:
            with INTERRUPTS.keeping():
                kept = self._keep(interrupt.result)
            raise KeyboardInterrupt(kept) from interrupt
        if self._output is not None and result is not earlier:
            save_or_rescue(result.save, self._output)
        return result

    def _train(
        self, earlier: TrainingResult | None, threads: int | None, progress: Progress
    ) -> TrainingResult:
        try:
            return train(
                self._world,
                self._agent,
                threads=threads,
                progress=progress,
                checkpoint=self._checkpoint(),
                resume=earlier,
                **self._schedule,
            )
        except ValueError as error:
            if earlier is None:
                raise
            raise ResultFileError(f"{self._output}: {error}; use --force to overwrite") from error

    def _checkpoint(self) -> Checkpoint | None:
        """Function that saves the finished runs while others are trained."""
        path = self._output
        return None if path is None else lenient(lambda finished: finished.save(path), note)

    def _keep(self, finished: TrainingResult | None) -> str:
        """Save finished runs; return a message that says what was kept."""
        runs = self._schedule["runs"]
        if finished is None:
            return f"interrupted before the first of {runs} runs finished; nothing was saved"
        done = f"interrupted; {finished.run_ids.size} of {runs} runs are finished"
        if self._output is None:
            return f"{done}; they are lost, because no -o FILE was given"
        save_or_rescue(finished.save, self._output)
        return f"{done} and saved to {self._output}; run the same command again to resume"


def _summary(result: TrainingResult) -> dict[str, Any]:
    """Summary of a training; flights are the final greedy ones that reach the source."""
    world, converged = result.world, result.converged_episode >= 0
    terminal = result.agent.decision_process(world, result.learning).terminal
    shortest = {cost: shortest_path(world, terminal, cost) for cost in ("steps", "metres")}
    return {
        "agent": result.agent.name,
        "speed": world.speed,
        "states": world.n_states,
        "seed": result.schedule.seed,
        "runs": result.run_ids.size,
        "episodes": _spread(result.episodes_flown),
        "truncated_episodes": int(result.truncated.sum()),
        "labels": _spread(result.n_discrete_states),
        "converged_runs": int(converged.sum()),
        "converged_episode": _spread(result.converged_episode[converged]),
        "converged_flight_s": _spread(result.converged_steps[converged]),
        "converged_cpu_s": _spread(result.converged_cpu_s[converged]),
        "reached_runs": int(result.reached.sum()),
        "path_steps": _spread(result.path_steps[result.reached]),
        "path_length_m": _spread(result.path_length_m[result.reached]),
        "fewest_steps": shortest["steps"].steps,
        "shortest_length_m": shortest["metres"].length_m,
        "cpu_s": float(result.cpu_s.sum()),
    }


def _spread(values: NDArray[Any]) -> dict[str, float] | None:
    """Mean, minimum and maximum of values (n,); None for none."""
    if values.size == 0:
        return None
    return {"mean": float(values.mean()), "min": float(values.min()), "max": float(values.max())}


def _print(summary: dict[str, Any], output: Path | None) -> None:
    runs = summary["runs"]
    pairs = [
        ("agent", f"{summary['agent']}, speed {summary['speed']}, {summary['states']} cells"),
        ("runs", f"{runs} of {_text(summary['episodes'])} episodes, seed {summary['seed']}"),
        ("states", _text(summary["labels"])),
        ("truncated episodes", summary["truncated_episodes"]),
        ("CPU time", f"{summary['cpu_s']:.2g} s"),
        ("converged", f"{summary['converged_runs']} of {runs} (three equal flights in a row)"),
    ]
    if summary["converged_runs"]:
        pairs += [
            ("  after", f"{_text(summary['converged_episode'])} episodes"),
            ("  flown", f"{_text(summary['converged_flight_s'])} s"),
            ("  CPU time", f"{_text(summary['converged_cpu_s'], 2)} s a run"),
        ]
    pairs += [
        ("final flight", f"{summary['reached_runs']} of {runs} reach the source"),
        ("  steps", f"{_text(summary['path_steps'])}; fewest possible {summary['fewest_steps']}"),
        (
            "  length",
            f"{_text(summary['path_length_m'], 2)} m; "
            f"shortest possible {summary['shortest_length_m']:.2f} m",
        ),
    ]
    print_pairs(pairs)
    if output is not None:
        say(f"saved to {output}")


def _text(spread: dict[str, float] | None, digits: int = 0) -> str:
    if spread is None:
        return "-"
    low, mean, high = (f"{spread[key]:.{digits}f}" for key in ("min", "mean", "max"))
    return mean if low == high else f"{mean} ({low} to {high})"
