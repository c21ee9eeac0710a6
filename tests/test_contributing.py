"""CONTRIBUTING.md's map of the code shows the folders there are, and its paths exist."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
PACKAGES = ("atomicfiles", "floorplans", "raytrace", "rssnav")


def folders_drawn() -> set[str]:
    """Folders of the tree, by indentation."""
    (tree,) = re.findall(r"```text\n(.*?)```", PAGE, flags=re.DOTALL)
    drawn, above = set[str](), list[str]()
    for indent, name in re.findall(r"^( *)([a-z_]+)/", tree, flags=re.MULTILINE):
        above[len(indent) // 2 :] = [name]
        drawn.add("/".join(above))
    return drawn


def packages_there_are() -> set[str]:
    modules = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {str(path.parent.relative_to(ROOT)) for path in modules}


def test_the_map_shows_every_package_down_to_the_stages_of_the_pipeline() -> None:
    stages = {p for p in packages_there_are() if p.count("/") <= 1}
    assert folders_drawn() >= stages
    assert folders_drawn() <= packages_there_are()


def test_every_path_it_names_exists() -> None:
    named = re.findall(r"`((?:docs|floorplans|raytrace|rssnav|tests)/[a-z0-9_/.]*)`", PAGE)
    assert [path for path in named if not (ROOT / path).exists()] == []
