"""Public names say what they take, give and raise, where the first line does not say it all."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = (
    "floorplans", "floorplans.exporters", "floorplans.generators", "floorplans.importers",
    "raytrace", "raytrace.antennas", "rssnav", "rssnav.envs", "rssnav.missions",
    "rssnav.policies",
)  # fmt: skip
OURS = ("floorplans", "raytrace", "rssnav")
ELSEWHERE = re.compile(r"\b(?:[Ss]ee|as of|as for)\s[^.]*`")
"""A docstring that names where its parameters are told."""

CHECKS = {"require": "ValueError", "check_gain_db": "ValueError", "check_elements": "ValueError"}
"""Functions that raise an exception unless something holds."""

SHAPE = re.compile(r"\((?:\.\.\.|[\w +*.-]+,[\w ,+*.-]*)\)|shape|scalar")
ARRAY = re.compile(r"NDArray|ArrayLike|ndarray|\bFloats\b|\bInts\b|\bBools\b|\bComplexes\b")


def functions_of(cls: type) -> Iterator[tuple[str, Callable[..., Any]]]:
    """Public methods that a class defines itself."""
    for name, member in vars(cls).items():
        found = getattr(member, "__func__", member)
        if inspect.isfunction(found) and not name.startswith("_"):
            yield name, found


def is_ours(obj: Any) -> bool:
    return getattr(obj, "__module__", "").split(".")[0] in OURS


def public() -> dict[str, Any]:
    """Classes and functions of the packages, and public methods, by their names; each once."""
    found: dict[int, tuple[str, Any]] = {}
    for package in PACKAGES:
        module = importlib.import_module(package)
        for name in module.__all__:
            obj = getattr(module, name)
            if isinstance(obj, ModuleType) or not is_ours(obj) or not callable(obj):
                continue
            found.setdefault(id(obj), (f"{package}.{name}", obj))
            if inspect.isclass(obj):
                for method, function in functions_of(obj):
                    found.setdefault(id(function), (f"{package}.{name}.{method}", function))
    return dict(found.values())


PUBLIC = public()


def is_call(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name)


def raised_in(function: Callable[..., Any]) -> set[str]:
    """Names of the exceptions that the source of a function raises itself."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    raises = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise)]
    made = [exc.func if isinstance(exc, ast.Call) else exc for exc in raises]
    names = {node.id for node in made if isinstance(node, ast.Name)}
    calls = {node.func.id for node in ast.walk(tree) if is_call(node)}
    names |= {CHECKS[name] for name in calls if name in CHECKS}
    return {name for name in names if name[0].isupper()} - {"NotImplementedError"}


def told(doc: str) -> dict[str, str]:
    """What a docstring tells of each parameter or attribute."""
    rows: dict[str, str] = {}
    for title in ("Parameters", "Attributes"):
        pattern = rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n---|\Z)"
        section = re.search(pattern, doc, re.MULTILINE | re.DOTALL)
        for row in re.split(r"^(?=\S)", section.group(1) if section else "", flags=re.MULTILINE):
            names = row.split("\n")[0].split(" :")[0]
            rows |= {name.strip().lstrip("*"): row for name in names.split(",")}
    return rows


def gaps_of_errors(obj: Any) -> Iterator[str]:
    doc = inspect.getdoc(obj) or ""
    makers = ("__init__", "__post_init__")
    functions = [vars(obj).get(name) for name in makers] if inspect.isclass(obj) else [obj]
    for function in functions:
        if inspect.isfunction(function) and ROOT in Path(function.__code__.co_filename).parents:
            missing = sorted(name for name in raised_in(function) if name not in doc)
            yield from (f"raises {name}" for name in missing)


def gaps_of_parameters(obj: Any) -> Iterator[str]:
    """Arrays without a shape, and several parameters of which not all are told."""
    doc = inspect.getdoc(obj) or ""
    if ELSEWHERE.search(doc):
        return
    rows = told(doc)
    parameters = [
        p for p in inspect.signature(obj).parameters.values() if p.name not in ("self", "cls")
    ]
    for parameter in parameters:
        row = rows.get(parameter.name)
        if row is None and (len(parameters) > 1 or ARRAY.search(str(parameter.annotation))):
            alone = rf"\b{parameter.name}\b|{SHAPE.pattern}"
            if not re.search(alone, doc.split("\n\n")[0]):
                yield f"nothing of {parameter.name}"
        elif row and ARRAY.search(str(parameter.annotation)) and not SHAPE.search(row):
            yield f"no shape of {parameter.name}"


def gaps_of_result(obj: Any) -> Iterator[str]:
    """A result that is an array has a shape."""
    annotation = str(inspect.signature(obj).return_annotation)
    doc = inspect.getdoc(obj) or ""
    section = re.search(r"^Returns\n-+\n(.*)", doc, re.MULTILINE | re.DOTALL)
    text = doc.split("\n\n")[0] + (section.group(1) if section else "")
    if ARRAY.search(annotation) and not SHAPE.search(text):
        yield "no shape of the result"


@pytest.mark.parametrize("name", PUBLIC)
def test_docstring_is_complete(name) -> None:
    obj = PUBLIC[name]
    assert inspect.getdoc(obj), "no docstring"
    gaps = list(gaps_of_errors(obj))
    if inspect.isfunction(obj):
        gaps += [*gaps_of_parameters(obj), *gaps_of_result(obj)]
    assert not gaps, f"{inspect.getsourcefile(obj)}: {gaps}"


def test_gaps_are_found() -> None:
    def poor(points: NDArray, other: int) -> NDArray:  # noqa: F821
        """Do something."""
        raise ValueError

    assert list(gaps_of_errors(poor)) == ["raises ValueError"]
    assert list(gaps_of_parameters(poor)) == ["nothing of points", "nothing of other"]
    assert list(gaps_of_result(poor)) == ["no shape of the result"]
