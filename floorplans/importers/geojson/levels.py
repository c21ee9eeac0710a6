"""One of the levels of a venue."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, cast

from floorplans.errors import PlanError
from floorplans.importers.geojson.features import levels_of, properties_of

Json = Mapping[str, Any]


def on_level(features: Sequence[Json], level: str | None) -> list[bool]:
    """Find the features on a level.

    Parameters
    ----------
    features : sequence of dict
        Those of a building; level features of IMDF among them name the levels.
    level : str or None
        Name, short name, ordinal or id of a level; may be None if there is only one.

    Returns
    -------
    list of bool
        True also for features without a level.

    Raises
    ------
    PlanError
        When there are several levels and none is chosen, or the chosen one does not exist.
    """
    names = _names(features)
    used = sorted({key for feature in features for key in levels_of(feature)}, key=_by_number)
    if level is None and len(used) <= 1:
        return [True] * len(features)
    chosen = {key for key in used if level is not None and _is_called(level, names[key])}
    if not chosen:
        shown = ", ".join(_shown(key, names[key]) for key in used) or "none"
        problem = "there are several levels" if level is None else "there is no such level"
        raise PlanError(f"{problem}; choose one of: {shown}", ("level",), level, remedy="level")
    if len(chosen) > 1:
        raise PlanError(f"several levels are called this: {', '.join(chosen)}", ("level",), level)
    return [not levels_of(feature) or bool(levels_of(feature) & chosen) for feature in features]


def _is_called(level: str, names: Sequence[str]) -> bool:
    """Whether a level has a name, whatever the case of its letters."""
    return level.casefold() in {name.casefold() for name in names}


def _names(features: Sequence[Json]) -> defaultdict[str, list[str]]:
    """Names of each level, its key first."""
    names: defaultdict[str, list[str]] = defaultdict(list)
    for key in {key for feature in features for key in levels_of(feature)}:
        names[key].append(key)
    for feature in features:
        if feature.get("feature_type") == "level":
            properties = properties_of(feature)
            texts = [
                text
                for key in ("short_name", "name", "ordinal")
                for text in _texts(properties.get(key))
            ]
            names[str(feature.get("id"))] += texts
    return names


def _texts(value: object) -> list[str]:
    """Texts of a name, which in IMDF is a table of languages."""
    if isinstance(value, dict):
        return [str(text) for text in cast("Json", value).values()]
    return [] if value is None else [str(value)]


def _by_number(key: str) -> tuple[float, str]:
    try:
        return float(key), key
    except ValueError:
        return float("inf"), key


def _shown(key: str, names: Sequence[str]) -> str:
    others = [name for name in names if name != key]
    return f"{key} ({', '.join(others)})" if others else key
