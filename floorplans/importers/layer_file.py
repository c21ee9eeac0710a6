"""The user's meanings of layers in a TOML file, to use them for other files too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from floorplans.errors import PlanError
from floorplans.importers.draft import LayerUse
from floorplans.loading import parse_toml
from floorplans.toml.table import Table, as_table
from floorplans.toml.values import toml_text


def read_layers(path: str | Path) -> dict[str, str]:
    """Read the table ``[layers]`` of a file: name or pattern = "KIND" or "KIND:MATERIAL".

    Raises
    ------
    PlanError
        When the file cannot be read or holds anything else. Kinds and materials are checked when
        they are used, since they depend on the format of the imported file.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise PlanError(f"not UTF-8 text: {error.reason}", origin=str(path)) from error
    except OSError as error:
        problem = f"the file of layers cannot be read: {error.strerror}"
        raise PlanError(problem, origin=str(path)) from error
    try:
        file = Table(parse_toml(text, str(path)), ("layers",))
        layers = as_table(file.data.get("layers"), None, ("layers",))
        return {name: layers.text(name) for name in layers.known}
    except PlanError as error:
        raise error.located(str(path)) from None


def layers_toml(layers: Mapping[str, str], uses: Sequence[LayerUse] = ()) -> str:
    """Text of a file that `read_layers` reads.

    Parameters
    ----------
    layers : mapping of str to str
        The user's meanings, the first that matches a name counts.
    uses : sequence of LayerUse
        What became of the layers of a file, which is added as comments.
    """
    lines = ["[layers]", *(f"{toml_text(k)} = {toml_text(v)}" for k, v in layers.items())]
    if uses:
        lines += ["", "# Found in the file:"]
        lines += [f"# {toml_text(use.name)}: {use.n_objects} objects: {use.became}" for use in uses]
    return "\n".join(lines) + "\n"
