"""The options of ``rssnav plan import``."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Annotated

import typer

from floorplans.importers import FORMATS, read_layers
from floorplans.importers.defaults import CLOSED_GAP_M

_KNOWN = "; ".join(f"{kind.title} ({', '.join(kind.suffixes)})" for kind in FORMATS)

ImportedFile = Annotated[
    Path,
    typer.Argument(metavar="FILE", help=f"Input file: {_KNOWN}.", show_default=False),
]
Output = Annotated[
    Path, typer.Option("-o", "--output", metavar="FILE", help="The .toml file to write.")
]
Name = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Name of the plan.", show_default="the file's"),
]
CeilingHeight = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        min=0.1,
        max=1000.0,
        help="From floor to ceiling in metres.",
        show_default="the file's, or 3",
    ),
]
WallThickness = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        min=1e-4,
        max=1000.0,
        help="Thickness in metres of walls for which the file gives none.",
        show_default="0.1",
    ),
]
WallMaterial = Annotated[
    str | None,
    typer.Option(
        metavar="MATERIAL",
        help="Material of walls for which the file gives none.",
        show_default="plasterboard, brick where thick",
    ),
]
SlabMaterial = Annotated[
    str | None,
    typer.Option(
        metavar="MATERIAL",
        help="Material of the floor or of the ceiling.",
        show_default="the file's, or concrete",
    ),
]
Source = Annotated[
    str | None,
    typer.Option(metavar="X,Y,Z", help="Transmitter in the plan.", show_default="away from walls"),
]
Start = Annotated[
    str | None,
    typer.Option(metavar="X,Y", help="Start of the search.", show_default="far from the source"),
]
Unit = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of length in the file: mm, cm, m, in, ft ...",
        show_default="the file's",
    ),
]
Level = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Storey to import; required if the file has several."),
]
Scale = Annotated[
    float | None,
    typer.Option(
        metavar="M", min=1e-4, max=1000.0, help="Side of a pixel in metres; required for pictures."
    ),
]
WallTolerance = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        min=1e-9,
        max=1000.0,
        help="Maximum distance in metres by which walls are moved to meet.",
        show_default="the format's",
    ),
]
KeepAxes = Annotated[
    bool,
    typer.Option(
        "--keep-axes",
        help="Keep the drawing's axes instead of rotating the plan to the building's own.",
    ),
]
CloseGaps = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        min=0.0,
        max=1000.0,
        help="Close gaps in the outline, up to this width in metres, with walls like those beside.",
        show_default=f"{CLOSED_GAP_M:g}",
    ),
]
Region = Annotated[
    str | None,
    typer.Option(
        metavar="X0,Y0,X1,Y1",
        help="Import only what lies between these corners, in the file's unit.",
        show_default="everything",
    ),
]
Layer = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=KIND[:MATERIAL]",
        help="Kind of a layer or type: wall, door, window or ignore; NAME may contain * and ?.",
    ),
]
Layers = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Kinds of layers saved by --save-layers.")
]
SaveLayers = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Save the kinds given by --layers and --layer to this .toml file."
    ),
]
ReportPage = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Write an .html page that shows the plan over the drawing, and what was left out, "
        "assumed and closed.",
    ),
]
Replace = Annotated[bool, typer.Option("--force", help="Overwrite FILE if it exists.")]


def start_of(text: str | None) -> tuple[float, float] | None:
    """Read --start."""
    if text is None:
        return None
    x, y = _numbers(text, "xy", "--start")
    return (x, y)


def source_of(text: str | None) -> tuple[float, float, float] | None:
    """Read --source."""
    if text is None:
        return None
    x, y, z = _numbers(text, "xyz", "--source")
    return (x, y, z)


def region_of(text: str | None) -> tuple[float, float, float, float] | None:
    """Read --region."""
    if text is None:
        return None
    x0, y0, x1, y1 = _numbers(text, ("x0", "y0", "x1", "y1"), "--region", "the file's unit")
    return (x0, y0, x1, y1)


def _numbers(
    text: str, names: Sequence[str], option: str, unit: str = "metres"
) -> tuple[float, ...]:
    """Read "1.5,2,1" as one number for each letter of `names`."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != len(names) or not all(map(isfinite, numbers)):
        shape = ",".join(names).upper()
        raise typer.BadParameter(f"{text!r} is not {shape} in {unit}.", param_hint=option)
    return numbers


def layers_of(texts: list[str] | None, file: Path | None) -> dict[str, str]:
    """Meanings of --layer, then those of --layers: the first that matches counts."""
    layers: dict[str, str] = {}
    for text in texts or ():
        name, equals, meaning = text.rpartition("=")
        if not equals or not name:
            raise typer.BadParameter(
                f"{text!r} is not NAME=KIND or NAME=KIND:MATERIAL.", param_hint="--layer"
            )
        layers[name] = meaning
    saved = {} if file is None else read_layers(file)
    return layers | {name: saved[name] for name in saved if name not in layers}
