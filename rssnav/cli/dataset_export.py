"""``rssnav dataset export`` and ``baselines``: use a data set elsewhere, and how hard it is."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from rssnav.cli.console import one_progress, print_json, print_table, say
from rssnav.cli.dataset_look import Folder
from rssnav.cli.options import Json, Seed, examples

LayoutName = Literal["challenge", "deepmimo", "zarr", "parquet"]


def add_to(group: typer.Typer) -> None:
    """Add the commands to the group ``dataset``."""
    group.command(
        "export",
        epilog=examples(
            "rssnav dataset make demo -o demo",
            "rssnav dataset export demo --layout parquet -o samples",
            "rssnav dataset export demo --layout challenge -o challenge",
        ),
    )(export)
    group.command(
        "baselines",
        epilog=examples("rssnav dataset make demo -o demo", "rssnav dataset baselines demo"),
    )(print_baselines)


def export(
    dataset: Folder,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="The folder to make.")],
    layout: Annotated[
        LayoutName,
        typer.Option(
            "--layout",
            help="challenge: PNG and CSV as in the 2025 indoor path loss challenge; deepmimo: npz "
            "of paths; zarr: a Zarr v3 store; parquet: samples for dataset catalogues.",
        ),
    ],
) -> None:
    """Write a data set in the layout of another project.

    Nothing is left behind if it fails.
    """
    from rssnav.datasets.exporters.formats import export_dataset

    with one_progress("plans") as progress:
        export_dataset(dataset, out, layout, progress)
    say(f"wrote {out}")


def print_baselines(dataset: Folder, seed: Seed = 0, as_json: Json = False) -> None:
    """Fit simple models to the training buildings, and print their errors in the test buildings."""
    from rssnav.datasets.baselines import baselines

    with one_progress("plans") as progress:
        rows = baselines(dataset, seed, progress)
    if as_json:
        print_json({"folder": str(dataset), "models": [vars(row) for row in rows]})
        return
    print_table(
        ("model", ">RMSE [dB]", ">mean absolute error [dB]", ">maps", ">cells"),
        [
            (row.model, f"{row.rmse_db:.2f}", f"{row.mae_db:.2f}", row.n_maps, row.n_cells)
            for row in rows
        ],
    )
