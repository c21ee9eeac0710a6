"""The map of the code shows the folders there are, and the files that the pages name exist."""

import os
import re

import pytest
import yaml
from documents import PAGES, ROOT

PACKAGES = ("atomicfiles", "floorplans", "raytrace", "rssnav")


def folders_drawn() -> set[str]:
    """Folders of the tree in CONTRIBUTING.md, by indentation."""
    page = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    (tree,) = re.findall(r"```text\n(.*?)```", page, flags=re.DOTALL)
    drawn, above = set[str](), list[str]()
    for indent, name in re.findall(r"^( *)([a-z_]+)/", tree, flags=re.MULTILINE):
        above[len(indent) // 2 :] = [name]
        drawn.add("/".join(above))
    return drawn


def packages_there_are() -> set[str]:
    modules = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {str(path.parent.relative_to(ROOT)) for path in modules}


def test_the_map_shows_every_package_down_to_the_stages_of_the_pipeline() -> None:
    stages = {package for package in packages_there_are() if package.count("/") <= 1}
    assert folders_drawn() >= stages
    assert folders_drawn() <= packages_there_are()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_path_it_names_exists(page) -> None:
    text = page.read_text("utf-8")
    named = re.findall(r"`((?:docs|floorplans|raytrace|rssnav|tests)/[a-z0-9_/.]*)`", text)
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_the_hosted_check_runs_the_project_s_own() -> None:
    folder = ROOT / ".github"
    workflow = yaml.safe_load((folder / "workflows" / "ci.yml").read_text("utf-8"))
    (job,) = workflow["jobs"].values()
    (command,) = [step["run"] for step in job["steps"] if "run" in step]
    assert os.access(ROOT / command, os.X_OK)


def test_issue_forms_ask_for_something_under_a_name() -> None:
    forms = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*_*.yml"))
    assert forms
    for path in forms:
        form = yaml.safe_load(path.read_text("utf-8"))
        assert form["name"]
        assert form["description"]
        assert all(part["attributes"]["label"] for part in form["body"])
