"""``rssnav dataset``: data sets of radio maps, made from a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rssnav.cli.console import note, one_progress, print_json, print_pairs, say
from rssnav.cli.options import Json, MaxMemory, Threads, examples, in_bytes
from rssnav.interrupts import INTERRUPTS

if TYPE_CHECKING:
    from rssnav.datasets.engines.job import Engine

MAX_WORKERS = 10_000


def add_to(parent: typer.Typer) -> None:
    """Add the group ``dataset``."""
    from rssnav.cli import dataset_export, dataset_look

    group = typer.Typer(
        no_args_is_help=True,
        help="Make, check and export data sets of radio maps.",
        epilog=examples(
            "rssnav dataset make demo -o demo",
            "rssnav dataset check demo",
        ),
    )
    group.command(
        "make",
        epilog=examples(
            "rssnav dataset make demo -o demo --estimate",
            "rssnav dataset make demo -o demo",
            "rssnav dataset make demo -o demo --workers 8",
        ),
    )(make)
    dataset_look.add_to(group)
    dataset_export.add_to(group)
    parent.add_typer(group, name="dataset")


def make(
    spec: Annotated[
        str,
        typer.Argument(
            metavar="SPEC",
            help="A TOML file, or a built-in spec: demo, rssnav-offices-1k.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="The folder to write into.")
    ],
    estimate: Annotated[
        bool, typer.Option("--estimate", help="Print what it will cost, and make nothing.")
    ] = False,
    threads: Threads = None,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=1,
            max=MAX_WORKERS,
            help="Start a Dask cluster of N processes on this machine.",
            show_default="threads of one process",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Use the Dask cluster of this scheduler.", show_default=False
        ),
    ] = None,
    max_memory: MaxMemory = None,
    retry: Annotated[
        bool, typer.Option("--retry", help="Retry plans that could not be traced.")
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite a data set of another spec in FOLDER.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Make a data set of radio maps, or complete one that was interrupted.

    Finished plans are saved: after an interruption the same command traces only the others. The
    number of processors and machines does not change the result.
    """
    from rssnav.datasets.making import estimate_dataset, make_dataset
    from rssnav.datasets.spec import load_spec

    if workers is not None and scheduler is not None:
        raise typer.BadParameter("give one of --workers and --scheduler.")
    loaded = load_spec(spec)
    if estimate:
        cost = estimate_dataset(loaded, out)
        if as_json:
            print_json(vars(cost))
        else:
            say(cost.sentence(_workers(threads, workers)))
        return
    engine = _engine(threads, workers, scheduler, in_bytes(max_memory))
    try:
        with one_progress("maps") as progress:
            made = make_dataset(
                loaded, out, engine, notice=note, progress=progress, retry=retry, force=force
            )
    except KeyboardInterrupt as interrupt:
        INTERRUPTS.reported()
        raise KeyboardInterrupt(
            f"interrupted; finished plans are saved in {out}; run the same command again to resume"
        ) from interrupt
    summary = {"folder": str(out), **vars(made)}
    if as_json:
        print_json(summary)
    else:
        print_pairs(
            [
                ("folder", out),
                ("plans", made.n_plans),
                ("maps", made.n_maps),
                ("traced now", f"{made.n_traced} plans"),
                *(
                    [("failed", f"{made.n_failed} plans, see failures.json")]
                    if made.n_failed
                    else []
                ),
            ]
        )


def _workers(threads: int | None, workers: int | None) -> int:
    from raytrace.threads import n_threads

    return workers or n_threads(threads)


def _engine(
    threads: int | None, workers: int | None, scheduler: str | None, max_memory_bytes: int | None
) -> Engine:
    if workers is None and scheduler is None:
        from rssnav.datasets.engines.threads import Threads as ThreadEngine

        return ThreadEngine(threads, max_memory_bytes)
    from rssnav.datasets.engines.cluster import Cluster

    return Cluster(workers, scheduler, max_memory_bytes)
