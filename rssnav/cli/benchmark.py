"""``rssnav benchmark``: policies in buildings that they have not seen."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rssnav.cli.console import print_table, say, stage_progress
from rssnav.cli.options import Threads, examples


def add_to(parent: typer.Typer) -> None:
    """Add the command ``benchmark``."""
    parent.command(
        "benchmark",
        epilog=examples(
            "rssnav benchmark --quick",
            "rssnav benchmark --out benchmark",
            "rssnav benchmark --policy mine:make_policy --track RSS --out mine",
            "rssnav benchmark --with mine/results.json",
        ),
    )(run_benchmark)


def run_benchmark(
    quick: Annotated[
        bool,
        typer.Option("--quick", help="6 generated buildings and 2 seeds: at most 3 minutes."),
    ] = False,
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Output folder.")] = Path("benchmark"),
    policy: Annotated[
        str | None,
        typer.Option(
            metavar="MODULE:FUNCTION",
            help="Evaluate only this policy: a function that returns a policy, given a Briefing.",
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Name of it in the tables.", show_default="the function"),
    ] = None,
    track: Annotated[
        str | None,
        typer.Option(
            metavar="TRACK",
            help="What it is told: RSS (by default), plan, maps, places or world; without "
            "--policy, evaluate only those of this track.",
            show_default=False,
        ),
    ] = None,
    split: Annotated[
        str,
        typer.Option(
            metavar="SPLIT", help="Generated buildings: train or validation to tune, test to score."
        ),
    ] = "test",
    buildings: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=0, max=200, help="Number of generated buildings.", show_default="50"
        ),
    ] = None,
    seeds: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=1000, help="Number of seeds.", show_default="10"),
    ] = None,
    plans: Annotated[
        list[str] | None,
        typer.Option(
            "--plan",
            metavar="PLAN",
            help="Fly in this plan too, a file or a built-in one; may be repeated.",
        ),
    ] = None,
    beside: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="FILE", help="Add the scores of another results.json."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume/--no-resume", help="Resume from saved flights, or start over.")
    ] = True,
    threads: Threads = None,
) -> None:
    """Fly policies in buildings that they have not seen, and score them.

    Writes results.json, table.md and page.html. Finished flights are saved in the output folder, so
    that the same command resumes after Ctrl-C or a crash.
    """
    from rssnav.benchmark.page import table_rows, write
    from rssnav.benchmark.policies import policies_of, policy_of
    from rssnav.benchmark.protocol import FULL, QUICK, extent_of
    from rssnav.benchmark.running import run
    from rssnav.benchmark.scores import scores
    from rssnav.benchmark.submissions import check_names, merged, read_scores

    specs = policies_of(track)
    if policy is not None:
        specs = (policy_of(policy, track or "RSS", name),)
    extent = extent_of(QUICK if quick else FULL, split, buildings, plans or (), seeds)
    others = merged([read_scores(path, extent) for path in beside or ()])
    check_names(specs, others)
    try:
        with stage_progress() as show:
            records = run(specs, extent, out, threads=threads, resume=resume, show=show)
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished flights are saved in {out}; run the same command again to "
            "resume"
        ) from interrupt
    found = merged([scores(records), others])
    files = write(out, found, extent)
    head = ("buildings", "condition", "policy", "track", "success", "SPL (95 %)")
    print_table(head, table_rows(found))
    for file in files:
        say(str(file))
