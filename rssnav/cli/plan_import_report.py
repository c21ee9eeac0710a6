"""What ``rssnav plan import`` prints and writes about an import."""

from collections import Counter
from dataclasses import asdict
from pathlib import Path

from atomicfiles import atomic_write
from floorplans.importers import DraftPlan, Imported, ImportRecord, import_page
from floorplans.importers.layer_names import meaning_of
from floorplans.repair.walls import REACH_M, Change
from rssnav.cli.console import note, print_json, print_table, say
from rssnav.cli.failures import print_error
from rssnav.cli.plan_summary import print_summary, summary_of

LISTED_CHANGES = ("closed", "dropped", "raised")
"""Kinds of changes that are listed one by one; of the others the report gives the number."""
_MOST_LISTED = 40


def print_import_json(imported: Imported, output: Path) -> None:
    """Print all about an import, for programs."""
    print_json(
        {
            "output": str(output),
            **summary_of(imported.plan),
            "origin": asdict(imported.origin),
            "layers": [asdict(use) for use in imported.layers],
            "assumed": [asdict(assumption) for assumption in imported.assumed],
            "changes": [asdict(change) for change in imported.changes],
            "warnings": imported.warnings,
            "parts": [asdict(part) for part in imported.parts],
            "notes": imported.notes,
        }
    )


def print_import(imported: Imported, output: Path) -> None:
    """Print what became of the layers, what was assumed and repaired, and the plan's size."""
    if imported.layers:
        rows = [(use.name, use.n_objects, use.became) for use in imported.layers]
        print_table(("layer", ">objects", "became"), rows)
        _print_layer_option(imported)
        print()
    if imported.assumed:
        print_table(
            ("assumed", "value", "why"), [(a.key, a.value, a.why) for a in imported.assumed]
        )
        print()
    _print_changes(imported.changes)
    for sentence in imported.notes:
        say(sentence)
    print_summary(imported.plan)
    print_warnings(imported)
    say(f"\nwrote {output}; view it with: rssnav plan show {output}")


def print_warnings(imported: ImportRecord) -> None:
    """Write what the user should look at to standard error."""
    for sentence in imported.warnings:
        print_error(f"warning: {sentence}")
    other = next((part for part in imported.parts if not part.is_taken), None)
    if other is not None:
        corners = ",".join(f"{number:g}" for number in other.bounds)
        note(f"import another drawing of the sheet with --region={corners}")


def _print_layer_option(imported: Imported) -> None:
    """Propose to import the unknown layer with the longest lines."""
    drawn = imported.original.layers if imported.original is not None else ()
    length_of = {layer.name: layer.geometry.length for layer in drawn}
    unknown = [
        use.name
        for use in imported.layers
        if use.is_unknown and length_of.get(use.name, 1.0) and meaning_of(use.name).kind is None
    ]
    if unknown:
        longest = max(unknown, key=lambda name: length_of.get(name, 0.0))
        say(
            "import a layer with an unknown name as walls with, for example, "
            f"--layer '{longest}=wall'"
        )


def _print_changes(changes: tuple[Change, ...]) -> None:
    """Print the number of changes of each kind, and those that change the building."""
    if not changes:
        return
    counts = Counter(change.kind for change in changes)
    say("repaired: " + ", ".join(f"{n} {kind}" for kind, n in counts.items()))
    listed = [change for change in changes if change.kind in LISTED_CHANGES]
    for change in listed[:_MOST_LISTED]:
        say(f"  {change}")
    if len(listed) > _MOST_LISTED:
        say(f"  ... and {len(listed) - _MOST_LISTED} more; --json and --report list all")
    print()


def write_draft(draft: DraftPlan, output: Path, force: bool) -> None:
    """Write a draft and a picture of its gaps beside the output, and say how to go on.

    Parameters
    ----------
    draft : DraftPlan
    output : Path
        Of the plan that could not be written.
    force : bool
        Whether to replace an existing draft.
    """
    from floorplans.pictures.gaps import save_gap_picture

    file, picture = output.with_suffix(".draft.toml"), output.with_suffix(".draft.png")
    if file.exists() and not force:
        note(f"{file} already exists; use --force to overwrite")
        return
    with atomic_write(file) as beside:
        beside.write_text(draft.toml(), encoding="utf-8", newline="\n")
    save_gap_picture(draft.plan, draft.gaps, picture)
    note(f"wrote {file}, a draft that cannot be traced yet, and {picture}, which marks its gaps")
    note(
        f"correct the draft, then: rssnav plan check {file} --fix -o {output} (--fix makes walls "
        f"meet that miss each other by up to {REACH_M:g} m; it closes no gaps)"
    )


def write_page(record: ImportRecord, path: Path | None) -> None:
    """Write the page of --report, if asked for."""
    if path is None:
        return
    with atomic_write(path) as beside:
        beside.write_text(import_page(record), encoding="utf-8", newline="\n")
    note(f"wrote {path}, which shows the plan over the drawing; open it in a browser")
