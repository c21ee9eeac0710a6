"""The meaning of layers, blocks and types from their names.

Names are split into words at everything but letters, and at changes from lower to upper case; a
word decides if it begins with one of those below. The words are those of the AIA and ISO 13567
layer lists and of common drawings in English, German, French, Spanish, Italian, Portuguese, Dutch,
Swedish, Polish and Turkish.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Literal, TypeVar, get_args

from floorplans.errors import PlanError, unknown_name
from floorplans.materials import MATERIALS

T = TypeVar("T")
Kind = Literal["wall", "door", "window", "ignore"]
KINDS: tuple[Kind, ...] = get_args(Kind)

_WORDS: tuple[tuple[Kind, tuple[str, ...]], ...] = (
    ("ignore", (
        "furn", "mobel", "moebel", "meubl", "mueble", "mobil", "text", "txt", "dim", "anno",
        "hatch", "schraff", "defpoint", "viewport", "vport", "title", "demol", "label",
    )),
    ("door", (
        "door", "tur", "tuer", "porte ", "porta ", "portes ", "puert", "deur", "dorr", "drzwi",
        "kapi", "gate",
    )),
    ("window", (
        "window", "wind", "wdw", "wndw", "fenst", "fenet", "ventan", "finest", "janel", "raam",
        "ramen", "fonst", "okn", "pencer",
    )),
    ("wall", (
        "wall", "wand", "waend", "mur", "pared", "paret", "muur", "vagg", "scian", "duvar", "mauer",
        "cloison", "tabiqu", "partit", "trennw", "aussenw", "innenw", "column", "cols", "stutz",
        "stuetz", "pilar", "pilast", "kolom", "poteau",
    )),
    ("ignore", (
        "sheet", "frame", "grid", "axis", "axe", "achs", "patt", "symb", "plant", "tree", "san ",
        "sanit", "plumb", "fixt", "equip", "light", "elec", "hvac", "duct", "pipe", "stair",
        "trepp", "escal", "floor", "boden", "ceil", "decke", "roof", "dach", "area", "room", "raum",
        "space", "zone", "overhead", "ovhd", "rail", "appl", "cabinet", "casework", "logo", "clng",
        "flor", "evtr", "lift",
    )),
)  # fmt: skip
"""The first match decides: a prefix of a word, or with a trailing space a whole word."""

_MATERIAL_WORDS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("concrete", ("conc", "beton", "hormig", "calcest", "stahlb")),
    ("brick", (
        "brick", "mason", "masonr", "mauerw", "ziegel", "briq", "ladrill", "matton", "cmu",
        "bakst", "tijol", "kalksand",
    )),
    ("plasterboard", (
        "plaster", "gyps", "gips", "dryw", "placo", "putz", "cartong", "yeso", "gkb", "trockenb",
    )),
    ("glass", ("glas", "glaz", "verre", "vidri", "vetro", "curtain", "szkl")),
    ("wood", ("wood", "timber", "holz", "bois", "mader", "legno", "hout")),
    ("metal", ("metal", "steel", "stahl", "acier", "acero", "alumin", "acciaio", "staal")),
)  # fmt: skip

_PLAIN = str.maketrans({"ß": "ss", "ł": "l", "ı": "i", "ø": "o"})
"""Letters that decomposition does not reduce to ASCII."""


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

    Raises
    ------
    PlanError
        When the mapping names an unknown kind or material.

    Examples
    --------
    >>> meaning_of("A-WALL-CONC")
    Meaning(kind='wall', material='concrete')
    >>> meaning_of("Türen").kind, meaning_of("cotes").kind
    ('door', None)
    """
    chosen = meaning_in(layers or {}, name, KINDS)
    if chosen is not None:
        return Meaning(*chosen)
    words = _words(name)
    material = _first(words, _MATERIAL_WORDS)
    kind: Kind | None = _first(words, _WORDS)
    if kind == "wall":
        return Meaning("wall", _named_material(words) or material)
    if kind is None and material is not None:
        return Meaning("wall", material)
    return Meaning(kind)


def material_named(name: str) -> str | None:
    """Material that a name refers to; None if it contains no known one.

    Examples
    --------
    >>> material_named("Stahlbeton C30/37"), material_named("Luft")
    ('concrete', None)
    """
    return _first(_words(name), _MATERIAL_WORDS)


def meaning_in(
    layers: Mapping[str, str], name: str, kinds: Sequence[T]
) -> tuple[T, str | None] | None:
    """Find kind and material of a name in the user's mapping; None if no pattern matches.

    Raises
    ------
    PlanError
        When the mapping names an unknown kind or material for it.
    """
    for pattern, text in layers.items():
        if fnmatchcase(name.casefold(), pattern.casefold()):
            return _parse_meaning(text, pattern, kinds)
    return None


def _parse_meaning(text: str, pattern: str, kinds: Sequence[T]) -> tuple[T, str | None]:
    """Parse KIND or KIND:MATERIAL."""
    kind_text, _, material = text.partition(":")
    by_name = {str(kind): kind for kind in kinds}
    kind = by_name.get(kind_text.strip())
    if kind is None:
        problem = unknown_name("kind of layer", kind_text, tuple(by_name))
        raise PlanError(problem, ("layers", pattern), text)
    material = material.strip() or None
    if material is not None and material not in MATERIALS:
        raise PlanError(unknown_name("material", material, MATERIALS), ("layers", pattern), text)
    return kind, material


def _words(name: str) -> list[str]:
    """Words of a name in lower case without accents."""
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    plain = unicodedata.normalize("NFKD", spaced.translate(_PLAIN))
    letters = "".join(c for c in plain if not unicodedata.combining(c))
    return re.findall(r"[a-z]+", letters.casefold())


def _named_material(words: list[str]) -> str | None:
    """Return the material whose full name is among the words; the longest if several."""
    text = f" {' '.join(words)} "
    named = [name for name in MATERIALS if f" {name.replace('_', ' ')} " in text]
    return max(named, key=len, default=None)


def _first(words: list[str], lists: tuple[tuple[T, tuple[str, ...]], ...]) -> T | None:
    """Return the first value for which a word has one of the beginnings."""
    for value, beginnings in lists:
        if any(f"{word} ".startswith(beginnings) for word in words):
            return value
    return None
