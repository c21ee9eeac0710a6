"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer


def _known_edition(edition: str | None) -> str | None:
    from floorplans import MATERIAL_EDITIONS

    if edition is None or edition.upper() in MATERIAL_EDITIONS:
        return edition and edition.upper()
    raise typer.BadParameter(f"{edition!r} is none of {', '.join(MATERIAL_EDITIONS)}.")


def _complete_plan(incomplete: str) -> list[str]:
    import floorplans

    return [name for name in floorplans.builtin_names() if name.startswith(incomplete)]


Plan = Annotated[
    str,
    typer.Argument(
        metavar="PLAN",
        help="A built-in plan (rssnav plan list) or a TOML file.",
        autocompletion=_complete_plan,
        show_default=False,
    ),
]
CellSize = Annotated[
    float, typer.Option("--cell-size", metavar="M", min=0.05, help="Side of a cell in metres.")
]
Height = Annotated[
    float, typer.Option("--height", metavar="M", help="Height of the receivers in metres.")
]
Reflections = Annotated[
    int,
    typer.Option("--reflections", metavar="N", min=0, max=20, help="Most reflections on a path."),
]
Diffractions = Annotated[
    int,
    typer.Option("--diffractions", metavar="N", min=0, max=1, help="Most diffractions on a path."),
]
Transmissions = Annotated[
    int,
    typer.Option(
        "--transmissions", metavar="N", min=0, max=20, help="Most walls that a path goes through."
    ),
]
MinPower = Annotated[
    float | None,
    typer.Option(
        "--min-power",
        metavar="DBM",
        help="Leave out paths known to be weaker; the map bounds what is missing.",
        show_default="none is left out",
    ),
]
MaxPaths = Annotated[
    int | None,
    typer.Option(
        "--max-paths",
        metavar="N",
        min=1,
        help="Raise --min-power until the map takes no more paths than this.",
        show_default="no limit",
    ),
]
Frequency = Annotated[
    float,
    typer.Option("--frequency", metavar="GHZ", min=0.001, help="Carrier frequency in GHz."),
]
Power = Annotated[
    float, typer.Option("--power", metavar="DBM", help="Power fed to the source's antenna in dBm.")
]
Edition = Annotated[
    str | None,
    typer.Option(
        "--edition",
        metavar="P.2040-N",
        callback=_known_edition,
        help="Edition of ITU-R P.2040 for the built-in materials.",
        show_default="the plan's, else the newest",
    ),
]
Threads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        metavar="N",
        min=1,
        help="How many to work with; the result does not depend on it.",
        show_default="all processors",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]
Force = Annotated[
    bool, typer.Option("--force", help="Make it again, and replace whatever is at FILE.")
]
Picture = Annotated[
    Path | None,
    typer.Option(
        "--picture",
        metavar="FILE",
        help="Draw the map into a .png, .svg or .pdf.",
        show_default=False,
    ),
]


def _check_style(style: str | None) -> str | None:
    """Refuse a style that matplotlib does not know, as wrong usage."""
    if style is None:
        return None
    from rssnav.pictures.style import check_style

    try:
        check_style(style)
    except ValueError as error:
        raise typer.BadParameter(f"{error}.") from error
    return style


Style = Annotated[
    str | None,
    typer.Option(
        "--style",
        metavar="NAME",
        callback=_check_style,
        help="Lay a matplotlib style over the project's own: its name, or a .mplstyle file.",
        show_default=False,
    ),
]

PICTURE_SUFFIXES = (".png", ".svg", ".pdf")


def examples(*commands: str) -> str:
    """Text below a command's help: command lines that work when pasted."""
    return "\n\n".join(["Examples:", *(f"  {command}" for command in commands)])


def check_suffix(path: Path | None, known: tuple[str, ...], option: str) -> None:
    """Refuse a file whose name does not end in a known format's suffix, as wrong usage."""
    if path is not None and path.suffix.lower() not in known:
        found = f"the suffix {path.suffix!r}" if path.suffix else "no suffix"
        raise typer.BadParameter(
            f"{path} has {found}; the format follows from it: give one of {', '.join(known)}.",
            param_hint=option,
        )
