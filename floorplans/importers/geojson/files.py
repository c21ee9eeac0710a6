"""Features from a GeoJSON file, or from the files of an IMDF archive or folder."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile, ZipFile, is_zipfile

from floorplans.errors import PlanError

MAX_BYTES = 64 * 2**20
"""Largest size of a file, or of all files of an archive together [bytes]."""

MAX_FEATURES = 100_000
MAX_FILES = 100

IMDF_FILES = ("level", "unit", "opening", "fixture", "footprint")
"""Files of an IMDF archive that contain walls."""

Json = dict[str, Any]


@dataclass(frozen=True)
class Collection:
    """All features of a file or venue.

    Attributes
    ----------
    features : tuple of dict
        As `json` reads them.
    crs : str or None
        Name of the coordinate reference system, "" for an explicit null, None if absent.
    document : dict
        The whole document of a single file; empty for a venue.
    """

    features: tuple[Json, ...]
    crs: str | None
    document: Json


def read_collection(path: Path) -> Collection:
    """Read a GeoJSON file, or an IMDF archive or folder; raise `PlanError` if it is neither."""
    if path.is_dir() or is_zipfile(path):
        texts = _folder_texts(path) if path.is_dir() else _archive_texts(path)
        documents = [_document(text, f"{path}/{name}") for name, text in texts]
        return _collection(documents, {})
    _check_bytes(path.stat().st_size, str(path))
    document = _document(path.read_bytes(), str(path))
    return _collection([document], document)


def _collection(documents: list[Json], document: Json) -> Collection:
    features = tuple(feature for each in documents for feature in _features(each))
    if not features:
        raise PlanError("there is no feature in the file; a building has walls or rooms")
    if len(features) > MAX_FEATURES:
        raise PlanError(
            f"there are {len(features)} features, at most {MAX_FEATURES} can be read; "
            "cut out one building, or one floor of it"
        )
    names = {_crs_name(each) for each in [*documents, *features] if "crs" in each}
    if len(names) > 1:
        shown = ", ".join(sorted(name or "null" for name in names))
        raise PlanError(
            f"features are in different coordinate systems ({shown}); bring them into one",
            ("crs",),
        )
    return Collection(features, names.pop() if names else None, document)


def _features(document: Json) -> list[Json]:
    kind = document.get("type")
    if kind == "Feature":
        return [document]
    if kind != "FeatureCollection":
        raise PlanError("expected a FeatureCollection or a Feature of GeoJSON", ("type",), kind)
    features = document.get("features")
    if not isinstance(features, list):
        raise PlanError("expected a list of features", ("features",))
    for index, feature in enumerate(cast("list[object]", features)):
        if not isinstance(feature, dict):
            raise PlanError("expected a feature, an object of JSON", ("features", index), feature)
    return cast("list[Json]", features)


def _crs_name(holder: Json) -> str:
    crs = holder["crs"]
    if crs is None:
        return ""
    try:
        return str(crs["properties"]["name"])
    except (KeyError, TypeError) as error:
        raise PlanError(
            'expected {"type": "name", "properties": {"name": ...}}', ("crs",)
        ) from error


def _document(text: bytes, origin: str) -> Json:
    try:
        document = json.loads(text)
    except UnicodeDecodeError as error:
        raise PlanError(f"not UTF-8 text: {error.reason}", origin=origin) from error
    except RecursionError as error:
        raise PlanError("brackets are nested too deep for GeoJSON", origin=origin) from error
    except ValueError as error:
        raise PlanError(f"not valid JSON: {error}", origin=origin) from error
    if not isinstance(document, dict):
        raise PlanError("expected an object of GeoJSON", origin=origin)
    return cast("Json", document)


def _folder_texts(path: Path) -> Iterator[tuple[str, bytes]]:
    files = [file for file in sorted(path.iterdir()) if _holds_walls(file.name)]
    _check_found(len(files))
    _check_bytes(sum(file.stat().st_size for file in files), str(path))
    for file in files:
        yield file.name, file.read_bytes()


def _archive_texts(path: Path) -> Iterator[tuple[str, bytes]]:
    """Read the wanted members in memory, each up to the size that the archive states."""
    try:
        with ZipFile(path) as archive:
            members = [info for info in archive.infolist() if _holds_walls(info.filename)]
            _check_found(len(members))
            _check_bytes(sum(info.file_size for info in members), str(path))
            for info in members:
                with archive.open(info) as file:
                    yield info.filename, file.read(info.file_size)
    except PlanError:
        raise
    except (BadZipFile, zlib.error, RuntimeError, EOFError, ValueError, OSError) as error:
        raise PlanError(f"the archive cannot be read: {error}", origin=str(path)) from error


def _holds_walls(name: str) -> bool:
    stem, _, ending = name.rsplit("/", 1)[-1].lower().rpartition(".")
    return stem in IMDF_FILES and ending in ("geojson", "json")


def _check_found(n_files: int) -> None:
    if n_files == 0:
        wanted = ", ".join(f"{name}.geojson" for name in IMDF_FILES)
        raise PlanError(f"no IMDF venue: none of its files {wanted} is there")
    if n_files > MAX_FILES:
        raise PlanError(f"{n_files} files look like parts of an IMDF venue, which has one of each")


def _check_bytes(n_bytes: int, origin: str) -> None:
    if n_bytes > MAX_BYTES:
        raise PlanError(
            f"{n_bytes / 2**20:.0f} MiB to read, at most {MAX_BYTES / 2**20:.0f} MiB are; "
            "cut out one building, or one floor of it",
            origin=origin,
        )
