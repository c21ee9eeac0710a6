"""Which layers of a drawing hold walls, doors and windows, and what became of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from shapely.geometry import LinearRing, LineString, MultiLineString

from floorplans.errors import PlanError
from floorplans.importers.draft import LayerUse
from floorplans.importers.dxf.drawing import Content
from floorplans.importers.layer_names import Kind, Meaning, is_foundation, meaning_of
from floorplans.importers.original import DrawnLayer, Original

_NO_WALL_NAMES = "no layer is named like walls"


@dataclass(frozen=True)
class Layers:
    """Meaning of each layer, its objects, and the reason where it is not the name."""

    meanings: Mapping[str, Meaning]
    content: Content
    why: Mapping[str, str]

    def of(self, kind: Kind) -> tuple[str, ...]:
        """Names of the layers of a kind that contain lines, in order."""
        return tuple(
            name
            for name, meaning in self.meanings.items()
            if meaning.kind == kind and self.content.curves.get(name)
        )

    def material(self, layer: str) -> str | None:
        """Material of the walls of a layer."""
        return self.meanings[layer].material

    def is_guess(self, layer: str) -> bool:
        """Whether a layer is taken for walls because no layer is named like walls."""
        return self.why.get(layer) == _NO_WALL_NAMES

    def uses(self) -> tuple[LayerUse, ...]:
        """What became of each layer."""
        return tuple(
            LayerUse(name, self.content.n_objects[name], self._became(name), self._is_unknown(name))
            for name in sorted(self.meanings, key=str.casefold)
        )

    def original(self, metric: Content) -> Original:
        """Everything that is drawn in model space [m]."""
        return Original(tuple(self._drawn(use, metric) for use in self.uses()))

    def _drawn(self, use: LayerUse, metric: Content) -> DrawnLayer:
        curves = [*metric.curves.get(use.name, ()), *metric.left_out.get(use.name, ())]
        symbols = [c for s in metric.symbols if s.layer == use.name for c in s.curves]
        is_used = bool(symbols) or self.meanings[use.name].kind not in (None, "ignore")
        lines = [
            LineString([*curve.points, *curve.points[: curve.closed]])
            for curve in (*curves, *symbols)
        ]
        lines += [LinearRing(hole) for curve in curves for hole in curve.holes]
        return DrawnLayer(use.name, use.became, is_used, MultiLineString(lines))

    def _is_unknown(self, name: str) -> bool:
        return self.meanings[name].kind is None and not is_foundation(name)

    def _became(self, name: str) -> str:
        meaning = self.meanings[name]
        n_symbols = sum(symbol.layer == name for symbol in self.content.symbols)
        parts: list[str] = []
        if meaning.kind not in (None, "ignore") and self.content.curves.get(name):
            of = f" of {meaning.material}" if meaning.material else ""
            parts.append(f"{meaning.kind}s{of}")
        if n_symbols:
            parts.append(f"{n_symbols} block{'s' * (n_symbols != 1)} of doors and windows")
        why = self.why.get(name, "")
        return (", ".join(parts) or "left out") + (f" ({why})" if why else "")


def layers_of(content: Content, given: Mapping[str, str]) -> Layers:
    """Find the meaning of each layer.

    If no layer is known to hold walls, the layers of unknown meaning are taken for walls.

    Parameters
    ----------
    content : Content
    given : mapping of str to str
        Meanings that the user gives.

    Raises
    ------
    PlanError
        When no lines could be walls.
    """
    why: dict[str, str] = {}
    meanings: dict[str, Meaning] = {}
    for name in content.n_objects:
        meanings[name] = meaning_of(name, given)
        if name in content.hidden and name not in given:
            meanings[name], why[name] = Meaning("ignore"), "off or frozen in the drawing"
        elif meanings[name].kind is None:
            why[name] = "a foundation" if is_foundation(name) else "unknown name"
    layers = Layers(meanings, content, why)
    if not layers.of("wall"):
        unknown = {n for n, m in meanings.items() if m.kind is None and content.curves.get(n)}
        meanings |= dict.fromkeys(unknown, Meaning("wall"))
        why |= dict.fromkeys(unknown, _NO_WALL_NAMES)
    if not layers.of("wall"):
        raise _no_walls(content)
    return layers


def missing_blocks(content: Content) -> str:
    """What to do about blocks of other files; empty if there are none."""
    if not content.missing:
        return ""
    names = ", ".join(sorted(content.missing)[:10])
    return f"the blocks {names} are in other files: bind these external references and save"


def damaged_objects(content: Content, layers: Layers) -> str:
    """Say how many objects on layers that are used have no line that can be read; empty if none."""
    found = {
        name: n
        for name, n in sorted(content.damaged.items())
        if n and layers.meanings[name].kind not in (None, "ignore")
    }
    if not found:
        return ""
    total = sum(found.values())
    where = ", ".join(f"{n} on {name}" for name, n in [*found.items()][:10])
    return (
        f"{total} object{'s' * (total != 1)} left out, empty or with invalid coordinates: {where}"
    )


def _no_walls(content: Content) -> PlanError:
    problem = "; ".join(filter(None, ("no lines of walls were found", missing_blocks(content))))
    names = [name for name, _ in content.n_objects.most_common(20)]
    if not names:
        return PlanError(f"{problem}; the blocks in model space are empty")
    likely = max(names, key=lambda name: len(content.curves.get(name, ())))
    return PlanError(
        f"{problem}; say which layers hold them, such as {likely}=wall; "
        f"layers with objects: {', '.join(map(repr, names))}",
        remedy="layers",
    )
