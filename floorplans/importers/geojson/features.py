"""The kind of a GeoJSON feature (wall, door, window, room, outline ...) and its level.

Files name the kind of a feature in many ways. Supported are the feature types of IMDF, the tags of
OpenStreetMap's simple indoor tagging, and words under one of `KIND_KEYS`, in the languages of
`layer_names`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal, cast, get_args

from floorplans.importers.draft import ImportOptions
from floorplans.importers.layer_names import is_horizontal_opening, meaning_in, meaning_of
from floorplans.importers.material_names import (
    CAVITY,
    layer_material_named,
    matches,
    words_of,
)
from floorplans.materials import MATERIALS

Kind = Literal["wall", "door", "window", "passage", "room", "outline", "level", "ignore"]

KINDS: tuple[Kind, ...] = get_args(Kind)

KIND_KEYS = (
    "indoor", "kind", "feature_type", "featureType", "type", "class", "category", "element",
    "object", "layer",
)  # fmt: skip

WORDS: Mapping[str, Kind] = {
    "wall": "wall", "walls": "wall", "partition": "wall", "column": "wall", "pillar": "wall",
    "columns": "wall", "pillars": "wall", "structure": "wall",
    "door": "door", "doors": "door", "entrance": "door", "gate": "door",
    "opening": "door", "openings": "door",
    "window": "window", "windows": "window", "glazing": "window",
    "passage": "passage", "doorway": "passage", "archway": "passage",
    "room": "room", "rooms": "room", "unit": "room", "units": "room", "corridor": "room",
    "space": "room", "hall": "room", "office": "room", "walkway": "room", "hallway": "room",
    "outline": "outline", "footprint": "outline", "perimeter": "outline", "building": "outline",
    "level": "level", "floor": "level", "storey": "level", "story": "level",
    "amenity": "ignore", "anchor": "ignore", "address": "ignore", "detail": "ignore",
    "geofence": "ignore", "kiosk": "ignore", "occupant": "ignore", "relationship": "ignore",
    "section": "ignore", "venue": "ignore",
}  # fmt: skip
"""Last word of a name (building_outline, exterior-wall) -> what it is."""

_ROOM_WORDS = (
    "bedroom", "bathroom", "restroom", "kitchen", "toilet", "lobby", "raum ", "raume ", "*raum ",
    "*raume ", "zimmer ", "*zimmer ", "flur ", "*flur ", "diele ", "kuche ", "*kuche ", "kueche ",
    "bad ", "buro ", "buero ", "halle ", "*halle ", "piece ", "pieces ", "chambre", "couloir",
    "salle ", "salles ", "cuisine ", "bureau", "habitacion", "pasillo", "cuarto", "dormitorio",
    "cocina", "bano ", "oficina", "sala ", "salon ", "stanza", "stanze ", "corridoio", "cucina",
    "bagno", "ufficio", "quarto", "corredor", "cozinha", "escritorio", "kamer ", "*kamer ", "gang ",
    "keuken", "kantoor", "rum ", "korridor", "kok ", "kontor", "rom ", "kjokken", "huone",
    "keittio", "kaytava", "pokoj", "kuchnia", "korytarz", "mistnost", "chodba", "oda ", "koridor",
    "mutfak", "комнат", "коридор", "кухн",
)  # fmt: skip
"""Words for rooms, as in `floorplans.importers.material_names`."""

LEVEL_KEYS = ("level", "level_id", "levelId", "level_name", "floor", "storey", "building_level")

WALL_UNITS: Mapping[str, str | None] = {
    "structure": None, "wall": None, "column": None, "brick": "brick", "concrete": "concrete",
    "drywall": "plasterboard", "glass": "glass", "wood": "wood",
}  # fmt: skip
"""Categories of IMDF that are solid -> material."""

OPEN_UNITS = frozenset({"walkway", "corridor", "hallway", "opentobelow", "lobby", "area"})
"""Rooms of these categories have no wall where they adjoin each other."""

Json = Mapping[str, Any]


@dataclass(frozen=True)
class FeatureClass:
    """Meaning of a feature.

    Attributes
    ----------
    kind : Kind or None
        None if unknown.
    label : str
        Its name in the file, for the report.
    material : str or None
    is_open : bool
        Whether it is a room without walls to others of its kind.
    """

    kind: Kind | None
    label: str
    material: str | None = None
    is_open: bool = False


def classify(feature: Json, options: ImportOptions) -> FeatureClass:
    """Find what a feature is, from the user's layers or otherwise from the file."""
    properties = properties_of(feature)
    words = [text for key in KIND_KEYS for text in _texts(properties.get(key))]
    words = [*_texts(feature.get("feature_type")), *words, *_osm_words(properties)]
    label = words[0] if words else "(no kind)"
    for word in words:
        chosen = meaning_in(options.layers, word, KINDS)
        if chosen is not None:
            kind, material = chosen
            return FeatureClass(kind, word, material)
    material = _material(properties)
    if words and words[0] in ("unit", "fixture"):
        return _imdf(words[0], str(properties.get("category", "")), material)
    for word in words:
        if kind := _kind_of(word):
            material = material or meaning_of(word).material
            return FeatureClass(kind, word, material, word.lower() in OPEN_UNITS)
    return FeatureClass(None, label)


def levels_of(feature: Json) -> frozenset[str]:
    """Names of the levels of a feature; empty if the file states none."""
    properties = properties_of(feature)
    for key in LEVEL_KEYS:
        value = properties.get(key)
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            return frozenset(_level_names(str(value)))
    return frozenset()


def number_of(feature: Json, *keys: str) -> float | None:
    """Return the first number above 0 under one of the keys, or in text such as 2.5 m."""
    properties = properties_of(feature)
    for key in keys:
        match = re.match(r"\s*(\d+(?:\.\d+)?)\s*m?\s*$", str(properties.get(key)))
        if match and isfinite(number := float(match[1])) and number > 0:
            return number
    return None


def properties_of(feature: Json) -> Json:
    """Return a feature's properties, empty if there are none."""
    properties = feature.get("properties")
    return cast("Json", properties) if isinstance(properties, dict) else {}


def _imdf(feature_type: str, category: str, material: str | None) -> FeatureClass:
    label = f"{feature_type}/{category}" if category else feature_type
    if category in WALL_UNITS:
        return FeatureClass("wall", label, material or WALL_UNITS[category])
    kind = "room" if feature_type == "unit" else None
    return FeatureClass(kind, label, material, category in OPEN_UNITS)


def _osm_words(properties: Json) -> list[str]:
    return [
        key
        for key in ("door", "window", "entrance")
        if properties.get(key, "no") not in ("no", None, False)
    ]


def _kind_of(word: str) -> Kind | None:
    if is_horizontal_opening(word):
        return "ignore"
    last = words_of(word)[-1:]
    if last and last[0] in WORDS:
        return WORDS[last[0]]
    kind = meaning_of(word).kind
    if kind in (None, "ignore") and matches(words_of(word), _ROOM_WORDS):
        return "room"
    return None if kind == "ignore" else kind


def _texts(value: object) -> list[str]:
    return [value] if isinstance(value, str) and value else []


def _material(properties: Json) -> str | None:
    name = str(properties.get("material", "")).strip().lower()
    material = name if name in MATERIALS else layer_material_named(name)
    return None if material == CAVITY else material


def _level_names(text: str) -> list[str]:
    """Split OpenStreetMap's lists and ranges of levels: 0;1 and 0-2."""
    names: list[str] = []
    for part in text.split(";"):
        low_high = re.fullmatch(r"\s*(-?\d{1,3})-(-?\d{1,3})\s*", part)
        if low_high:
            names += [str(n) for n in range(int(low_high[1]), int(low_high[2]) + 1)]
        else:
            names.append(part.strip())
    return names
