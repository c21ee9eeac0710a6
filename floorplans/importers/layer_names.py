"""The meaning of layers, blocks and types from their names.

The words are those of the AIA, NCS and ISO 13567 layer lists and of common drawings in English,
German, French, Spanish, Italian, Portuguese, Dutch, Swedish, Norwegian, Danish, Finnish, Polish,
Czech, Turkish and Russian. How a word matches is described in `material_names`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import Literal, TypeVar, get_args

from floorplans.errors import PlanError, unknown_name
from floorplans.importers.material_names import (
    Lists,
    first_match,
    matches,
    material_named,
    wall_material_named,
    words_of,
)
from floorplans.materials import MATERIALS

Kind = Literal["wall", "door", "window", "passage", "ignore"]
KINDS: tuple[Kind, ...] = get_args(Kind)

T = TypeVar("T")

_WORDS: Lists[Kind] = (
    ("ignore", (
        "furn", "mobel", "mobl", "moeb", "meubl", "mueble", "mobil", "arred", "text", "txt", "dim",
        "anno", "hatch", "schraff", "defpoint", "viewport", "vport", "title", "ttlb", "demo ",
        "demol", "label", "iden ", "nplt ", "note ", "notes ", "void", "cote ", "cotes ", "cotat",
        "bemass", "beschrift", "acot", "skyl", "tremie", "tragaluz", "clarabo", "lucernari",
        "overhead", "ovhd", "abov ", "above ", "ecritur", "schrift", "escritur", "scritt",
    )),
    ("door", (
        "door", "tur ", "turen ", "turbl", "turrahm", "turzarg", "*haustur", "*innentur",
        "*zimmertur", "*aussentur", "*schiebetur", "*eingangstur", "tuer", "*tuer ", "*tueren ",
        "tor ", "tore ", "porte ", "porta ", "portes ", "portas ", "huisser", "menuis",
        "puert", "carpint", "infiss",
        "serrament", "esquadr", "deur", "kozijn", "dorr", "dor ", "dore ", "ovi ", "ovet ", "drzwi",
        "dvere", "kapi", "двер", "gate",
    )),
    ("window", (
        "window", "wind ", "wdw", "wndw", "fenst", "*fenster", "fenet", "ventan", "finest", "janel",
        "raam", "ramen", "fonst", "vindu", "ikkun", "okn", "pencer", "окн", "окон",
    )),
    ("passage", (
        "opening", "opng", "offnung", "*offnung", "oeffnung", "*oeffnung", "*durchbr", "durchgang",
        "ouvertur", "baie ", "baies ", "hueco", "vano ", "vanos ", "apertur", "abertur", "passage ",
        "sparing", "oppning", "проем",
    )),
    ("wall", (
        "wall", "wand", "*wand ", "waend", "*waende ", "*wande ", "*mauer ", "mauer", "mur",
        "refend", "voile ", "voiles ", "paroi", "maconner", "cloison", "pared", "paret", "tabiqu",
        "cerramient", "medianer", "tramez", "divisori", "alvenar",
        "muur", "vagg", "vegg", "vaeg", "seina", "scian", "stena", "steny", "duvar", "стен",
        "partit", "column", "coluna", "colon ", "cols", "pillar", "pfeil", "stutz", "stuetz",
        "pilar", "pilast", "kolom", "kolon", "poteau",
    )),
    ("window", ("glaz", "vitr", "verri", "acristal", "cristaler", "vidrier")),
    ("ignore", (
        "sheet", "frame", "*rahmen ", "plankopf", "schriftf", "schriftk",
        "grid", "axis", "axe", "achs", "patt", "symb", "plant", "tree", "san ",
        "sanit", "plumb", "fixt", "equip", "light", "elec", "hvac", "duct", "pipe", "stair",
        "trepp", "escal", "floor", "boden", "ceil", "decke", "roof", "dach", "area", "room", "raum",
        "space", "zone", "rail", "appl", "cabinet", "casework", "logo", "clng", "flor", "evtr",
        "lift", "source ", "start ", "transmitter",
    )),
)  # fmt: skip
"""The first match decides."""

_HORIZONTAL = (
    "floor", "flor ", "roof", "shaft", "slab", "ceil", "clng", "deck", "stair", "boden", "dach",
    "schacht", "trepp", "plancher", "dalle", "toit", "forjad", "cubiert", "solaio", "tetto", "laje",
    "vloer", "dak ",
)  # fmt: skip
"""An opening of these is a hole in a floor or ceiling."""
_ROOF = ("roof", "dachf", "dach ", "toit", "tetto")
_FOUNDATION = (
    "stem ", "fndn", "foundation", "footing", "fundam", "fondation", "cimient", "fundac",
)  # fmt: skip


@dataclass(frozen=True)
class Meaning:
    """Meaning of a name: a kind and a material, each None if unknown."""

    kind: Kind | None
    material: str | None = None


def meaning_of(name: str, layers: Mapping[str, str] | None = None) -> Meaning:
    """Find what a layer is, from the user's mapping or otherwise from its name.

    Parameters
    ----------
    name : str
    layers : mapping of str to str, optional
        Name or pattern with * and ? -> KIND or KIND:MATERIAL; case does not matter.

    Returns
    -------
    Meaning
        Openings in floors and roofs are "ignore"; foundation walls are None.

    Raises
    ------
    PlanError
        When the mapping names an unknown kind or material.

    Examples
    --------
    >>> meaning_of("A-WALL-CONC")
    Meaning(kind='wall', material='concrete')
    >>> meaning_of("Türen").kind, meaning_of("portrait").kind
    ('door', None)
    >>> meaning_of("A-OPENING").kind, meaning_of("floor_opening").kind
    ('passage', 'ignore')
    """
    chosen = meaning_in(layers or {}, name, KINDS)
    if chosen is not None:
        return Meaning(*chosen)
    words = words_of(name)
    material = material_named(name)
    kind = _kind_of(words)
    if kind == "wall" and is_foundation(name):
        return Meaning(None)
    if kind == "wall":
        return Meaning("wall", wall_material_named(name))
    if kind is None and material is not None:
        return Meaning("wall", material)
    return Meaning(kind)


def is_horizontal_opening(name: str) -> bool:
    """Whether a name is that of an opening in a floor, a roof or a shaft, and not in a wall.

    Examples
    --------
    >>> is_horizontal_opening("roof_opening"), is_horizontal_opening("Ground floor doors")
    (True, False)
    """
    words = words_of(name)
    kind = first_match(words, _WORDS)
    in_slab = kind == "passage" and matches(words, _HORIZONTAL)
    return in_slab or (kind == "window" and matches(words, _ROOF)) or matches(words, ("void",))


def is_foundation(name: str) -> bool:
    """Whether a name is that of a foundation, which lies below the floor of a storey."""
    return matches(words_of(name), _FOUNDATION)


def _kind_of(words: list[str]) -> Kind | None:
    kind: Kind | None = first_match(words, _WORDS)
    if is_horizontal_opening(" ".join(words)):
        return "ignore"
    if kind == "window" and words[0] == "i" and matches(words, ("glaz",)):
        return None  # NCS discipline Interiors: a glazed partition, and so a wall of its material
    return kind


def meaning_in(
    layers: Mapping[str, str], name: str, kinds: Sequence[T]
) -> tuple[T, str | None] | None:
    """Find kind and material of a name in the user's mapping; None if no pattern matches.

    Raises
    ------
    PlanError
        When the mapping names an unknown kind or material for it, with the nearest known one by
        its meaning or its letters.
    """
    for pattern, text in layers.items():
        if fnmatchcase(name.casefold(), pattern.casefold()):
            return _parse_meaning(text, pattern, kinds)
    return None


def _parse_meaning(text: str, pattern: str, kinds: Sequence[T]) -> tuple[T, str | None]:
    """Parse KIND or KIND:MATERIAL."""
    kind_text, _, material = (part.strip() for part in text.partition(":"))
    by_name = {str(kind): kind for kind in kinds}
    kind = by_name.get(kind_text)
    if kind is None:
        meant = meaning_of(kind_text).kind
        problem = unknown_name("kind of layer", kind_text, tuple(by_name), meant)
        raise PlanError(problem, ("layers", pattern), text)
    if material and material not in MATERIALS:
        problem = unknown_name("material", material, MATERIALS, material_named(material))
        raise PlanError(problem, ("layers", pattern), text)
    return kind, material or None


def unmatched(layers: Mapping[str, str], names: Iterable[str]) -> Iterator[str]:
    """Yield a sentence for each name of the user's mapping that matches none of the file's."""
    folded = {name.casefold(): name for name in names}
    for pattern in layers:
        if any(fnmatchcase(name, pattern.casefold()) for name in folded):
            continue
        near = get_close_matches(pattern.casefold(), folded, n=1)
        hint = f'; did you mean "{folded[near[0]]}"?' if near else ""
        yield f'nothing in the file is called "{pattern}"{hint}'
