"""Arguments and options that several commands share."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

MAX_RUNS = 100_000

_OF_PRESET = "the preset's"


def _known_edition(edition: str | None) -> str | None:
    from floorplans import MATERIAL_EDITIONS

    if edition is None or edition.upper() in MATERIAL_EDITIONS:
        return edition and edition.upper()
    raise typer.BadParameter(f"{edition!r} is not one of {', '.join(MATERIAL_EDITIONS)}.")


def _check_antenna(name: str | None) -> str | None:
    """Check that an antenna has a known name or a CSV file; otherwise it is wrong usage."""
    from floorplans.transmitters import ANTENNAS

    if name is None or name in ANTENNAS or name.lower().endswith(".csv"):
        return name
    raise typer.BadParameter(f"{name!r} is not {', '.join(ANTENNAS)} or the path of a .csv file.")


def _at_most(largest: int) -> Callable[[int | None], int | None]:
    """Check of a bound that only files and kernels have: help that prints it helps nobody."""

    def check(value: int | None) -> int | None:
        if value is not None and value > largest:
            raise typer.BadParameter(f"{value} is more than {largest}.")
        return value

    return check


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
    float,
    typer.Option("--cell-size", metavar="M", min=0.05, max=100.0, help="Cell size in metres."),
]
Height = Annotated[
    float,
    typer.Option(
        "--height", metavar="M", min=0.0, max=1000.0, help="Height of the receivers in metres."
    ),
]
Preset = Annotated[
    Literal["paper", "building"] | None,
    typer.Option(
        "--preset",
        help="paper: 6 reflections, opaque walls, vertical dipoles; building: 3 reflections, "
        "transmission, isotropic antennas of unknown polarisation. Other options override it.",
        show_default="paper for built-in plans, otherwise building",
    ),
]
Reflections = Annotated[
    int | None,
    typer.Option(
        "--reflections",
        metavar="N",
        min=0,
        max=20,
        help="Maximum number of reflections on a path.",
        show_default=_OF_PRESET,
    ),
]
Diffractions = Annotated[
    int | None,
    typer.Option(
        "--diffractions",
        metavar="N",
        min=0,
        max=1,
        help="Maximum number of diffractions on a path.",
        show_default=_OF_PRESET,
    ),
]
UNLIMITED = "none"
"""Value of --transmissions for any number of walls."""

_MOST_TRANSMISSIONS = 20


def _checked_transmissions(value: str | None) -> str | None:
    """Check a number of transmissions, or the word for an unlimited one."""
    if value is None or value == UNLIMITED:
        return value
    if not (value.isdecimal() and int(value) <= _MOST_TRANSMISSIONS):
        raise typer.BadParameter(
            f"{value!r} is neither an integer from 0 to {_MOST_TRANSMISSIONS} nor {UNLIMITED}."
        )
    return value


Transmissions = Annotated[
    str | None,
    typer.Option(
        "--transmissions",
        metavar="N",
        callback=_checked_transmissions,
        help="Maximum number of transmissions through walls on a path; "
        "none: no number, paths are limited by loss.",
        show_default=_OF_PRESET,
    ),
]
DynamicRange = Annotated[
    float | None,
    typer.Option(
        "--dynamic-range",
        metavar="DB",
        min=1.0,
        max=1000.0,
        help="Leave out paths this far below the reflected and transmitted power of a cell.",
        show_default="15 without a number of transmissions, otherwise no limit",
    ),
]
CheckLimits = Annotated[
    int | None,
    typer.Option(
        "--check-limits",
        metavar="N",
        min=1,
        max=1_000_000,
        help="Trace N random cells again with limits by power that are 15 dB wider, and say what "
        "the map lacks. It takes longer than the map; 59 cells tell of 95 % of all.",
        show_default=False,
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar="WHICH",
        help="Transmitter: an id in the plan, source, or X,Y,Z in metres.",
        show_default="the source, otherwise the plan's transmitter",
    ),
]
FromSeveral = Annotated[
    list[str] | None,
    typer.Option(
        "--from",
        metavar="WHICH",
        help="Transmitter: an id in the plan, source, X,Y,Z in metres, or all; repeatable.",
        show_default="the source, otherwise all transmitters",
    ),
]
MinPower = Annotated[
    float | None,
    typer.Option(
        "--min-power",
        metavar="DBM",
        min=-1000.0,
        max=200.0,
        help="Leave out paths below this power; the map stores a bound on what is missing.",
        show_default="-120 without a number of transmissions, otherwise no threshold",
    ),
]
MaxPaths = Annotated[
    int | None,
    typer.Option(
        "--max-paths",
        metavar="N",
        min=1,
        callback=_at_most(2**62),
        help="Maximum number of paths in the map; raises --min-power as needed.",
        show_default="no limit",
    ),
]


def _max_memory(default: str) -> Any:
    """Return the option of a command that traces, with its default in words."""
    return typer.Option(
        "--max-memory",
        metavar="GB",
        min=0.001,
        max=1e6,
        help="Memory limit of a trace in GB; a trace that needs more stops with an error.",
        show_default=default,
    )


MaxMemory = Annotated[float | None, _max_memory("half of what is free")]
MaxTabMemory = Annotated[float | None, _max_memory("1 for each tab")]
Frequency = Annotated[
    float | None,
    typer.Option(
        "--frequency",
        metavar="GHZ",
        min=0.001,
        max=1000.0,
        help="Carrier frequency in GHz.",
        show_default="the transmitter's in the plan, otherwise 2.4",
    ),
]
Power = Annotated[
    float | None,
    typer.Option(
        "--power",
        metavar="DBM",
        min=-200.0,
        max=200.0,
        help="Transmit power in dBm.",
        show_default="the transmitter's in the plan, otherwise 25",
    ),
]
AntennaName = Annotated[
    str | None,
    typer.Option(
        "--antenna",
        metavar="NAME",
        callback=_check_antenna,
        help="Transmit antenna: isotropic, unpolarised, dipole (vertical), monopole, patch, "
        "sector, or a CSV file with a pattern.",
        show_default="the transmitter's in the plan, otherwise the preset's",
    ),
]
ReceiveAntennaName = Annotated[
    str | None,
    typer.Option(
        "--receive-antenna",
        metavar="NAME",
        callback=_check_antenna,
        help="Receive antenna: isotropic, unpolarised, dipole (vertical), monopole, patch, "
        "sector, or a CSV file with a pattern.",
        show_default=_OF_PRESET,
    ),
]
Edition = Annotated[
    str | None,
    typer.Option(
        "--edition",
        metavar="P.2040-N",
        callback=_known_edition,
        help="Edition of ITU-R P.2040 for built-in materials.",
        show_default="the plan's, otherwise the newest",
    ),
]
Threads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        metavar="N",
        min=1,
        max=4096,
        help="Number of threads; does not change the result.",
        show_default="all processors",
    ),
]
Runs = Annotated[
    int, typer.Option("--runs", metavar="N", min=1, max=MAX_RUNS, help="Number of realisations.")
]
Seed = Annotated[
    int,
    typer.Option(
        "--seed",
        metavar="N",
        min=0,
        callback=_at_most(2**63 - 1),
        help="Seed of the random numbers.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]
Force = Annotated[bool, typer.Option("--force", help="Recompute, and overwrite what is there.")]
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
    """Check that matplotlib knows a style; otherwise it is wrong usage."""
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
        help="Matplotlib style applied over the default one: a name or a .mplstyle file.",
        show_default=False,
    ),
]

PICTURE_SUFFIXES = (".png", ".svg", ".pdf")


def examples(*commands: str) -> str:
    """Text below a command's help: command lines that work as they are."""
    return "\n\n".join(["Examples:", *(f"  {command}" for command in commands)])


def in_bytes(max_memory: float | None) -> int | None:
    """Convert --max-memory from gigabytes."""
    return None if max_memory is None else round(max_memory * 1e9)


def check_suffix(path: Path | None, known: tuple[str, ...], option: str) -> None:
    """Check that a file's suffix is that of a known format; otherwise it is wrong usage."""
    if path is not None and path.suffix.lower() not in known:
        found = f"the suffix {path.suffix!r}" if path.suffix else "no suffix"
        raise typer.BadParameter(
            f"{path} has {found}; it names the format: use one of {', '.join(known)}.",
            param_hint=option,
        )
