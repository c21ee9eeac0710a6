"""Materials from their names in other programs' files.

A name is split into words (`words_of`), and a word decides if it matches an entry of a list: a
prefix of the word; with a trailing space the whole word or its end; with a leading ``*`` anywhere.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from typing import TypeVar

from floorplans.materials import MATERIALS

T = TypeVar("T")
Lists = tuple[tuple[T, tuple[str, ...]], ...]

CAVITY = "air"
"""Material of cavities."""

_MATERIAL_WORDS: Lists[str] = (
    ("brick", (
        "brick", "mason", "masn ", "mauerw", "ziegel", "*ziegel ", "briq", "ladrill", "matton",
        "cmu", "bakst", "tijol", "kalksand", "klinker", "clinker", "macon", "murerv", "tegelst",
        "ytong", "poroton", "porenb", "parpaing", "mamposter", "muratura", "metselw", "tugla",
        "cegl", "blockw", "adobe",
    )),  # before concrete: masonry of concrete blocks is masonry
    ("concrete", ("conc", "beton", "hormig", "calcest", "stahlb", "gasbeton", "*beton ")),
    ("plasterboard", (
        "plaster", "gyps", "gips", "dryw", "placo", "putz", "cartong", "yeso", "trockenb",
        "gkb", "gk ", "gkf ", "rigips", "*gips", "*putz ", "gwb ", "gyp ",
    )),
    ("glass", ("glas", "glaz", "verre", "vidri", "vetro", "curtain", "szkl", "*glas ", "vitr")),
    ("wood", (
        "wood", "timber", "holz", "bois", "mader", "legno", "hout ", "houten", "plywood", "*holz ",
    )),
    ("metal", ("metal", "steel", "stahl", "acier", "acero", "alumin", "acciaio", "staal")),
)  # fmt: skip

_LAYER_WORDS: Lists[str] = (
    ("concrete", (
        "cement", "zement", "render", "mortar", "mortel", "mortier", "mortero", "malta ", "screed",
        "estrich", "stucco", "estuco", "enduit", "intonaco",
    )),
    ("brick", ("stone", "naturst", "pierre", "piedra", "pietra", "block ", "blocks ", "bloc ")),
    ("marble", ("marble", "marmor", "marbre", "marmol", "granit", "tile", "fliese", "carrel")),
    ("chipboard", ("chipb", "osb ", "mdf ", "spanpl", "particle")),
)  # fmt: skip
"""Materials of layers of a wall that are no walls by themselves."""

_STUD_WORDS = ("stud ", "studs ", "furr", "framing", "*stander", "*staender", "ossat", "montant")
_CAVITY_WORDS = (
    *_STUD_WORDS, "studwork", "joist", "rafter", "batten", "batt ", "air ", "airg", "airs", "airl",
    "cavit", "void", "gap ", "*insul", "*wool", "*wolle", "rockw", "fibergl", "fibregl", "foam",
    "*schaum", "mousse", "espuma", "polyst", "polyur", "poliest", "poliur", "styro", "eps ", "xps ",
    "pur ", "pir ", "luft", "*luftsch", "lucht", "hohlr", "*dammung", "*dammst", "*daemm", "damm",
    "isol", "aisla", "camara", "lame ", "laine", "lana ", "aria ", "interc",
    "unterkonstr", "latt", "spouw", "cellulo", "*zellul", "zwischenr",
)  # fmt: skip
"""Studs, furring, insulation and air: a wave passes between or through them as in air."""

_SOLID = ("concrete", "brick")
"""A name of these is no cavity, whatever else it says (insulating concrete)."""

_PLAIN = str.maketrans({"ß": "ss", "ł": "l", "ı": "i", "ø": "o", "æ": "ae", "Æ": "ae"})
"""Letters that decomposition does not reduce to ASCII."""


def material_named(name: str) -> str | None:
    """Material that a name refers to; None if it contains no known one.

    Examples
    --------
    >>> material_named("Stahlbeton C30/37"), material_named("Luft")
    ('concrete', None)
    >>> material_named("Concrete Masonry Units")
    'brick'
    """
    return first_match(words_of(name), _MATERIAL_WORDS)


def wall_material_named(name: str) -> str | None:
    """Material of a wall from its name; one of studs is plasterboard, whatever the studs are.

    Examples
    --------
    >>> wall_material_named("Metal stud wall"), wall_material_named("A-WALL-CONC")
    ('plasterboard', 'concrete')
    """
    words = words_of(name)
    material = full_name(words) or first_match(words, _MATERIAL_WORDS)
    if material in (None, "metal", "wood") and matches(words, _STUD_WORDS):
        return "plasterboard"
    return material


def layer_material_named(name: str) -> str | None:
    """Material of a layer of a wall, `CAVITY` for studs, insulation and air; None if unknown.

    Examples
    --------
    >>> layer_material_named("Metal - Stud Layer"), layer_material_named("Cement render")
    ('air', 'concrete')
    >>> layer_material_named("5/8 in. GWB"), layer_material_named("Gyp. Bd.")
    ('plasterboard', 'plasterboard')
    """
    words = words_of(name)
    material = full_name(words) or first_match(words, _MATERIAL_WORDS)
    if material not in _SOLID and matches(words, _CAVITY_WORDS):
        return CAVITY
    return material or first_match(words, _LAYER_WORDS)


def full_name(words: Sequence[str]) -> str | None:
    """Return the material whose full name is among the words; the longest if several."""
    text = f" {' '.join(words)} "
    named = [name for name in MATERIALS if f" {name.replace('_', ' ')} " in text]
    return max(named, key=len, default=None)


def words_of(name: str) -> list[str]:
    """Words of a name in lower case without accents, split also at a change to upper case."""
    plain = unicodedata.normalize("NFKD", name.translate(_PLAIN))
    letters = "".join(c for c in plain if not unicodedata.combining(c))
    spaced = "".join(
        f" {c}" if before.islower() and c.isupper() else c
        for before, c in zip(f" {letters}", letters, strict=False)
    )
    return re.findall(r"[^\W\d_]+", spaced.casefold())


def first_match(words: Sequence[str], lists: Lists[T]) -> T | None:
    """Return the first value one of whose entries matches a word."""
    return next((value for value, entries in lists if matches(words, entries)), None)


def matches(words: Sequence[str], entries: Sequence[str]) -> bool:
    """Whether a word matches an entry: a prefix, ``whole ``, or ``*anywhere``."""
    beginnings = tuple(entry for entry in entries if entry[0] != "*")
    within = [entry[1:] for entry in entries if entry[0] == "*"]
    return any(
        f"{word} ".startswith(beginnings) or any(part in f"{word} " for part in within)
        for word in words
    )
