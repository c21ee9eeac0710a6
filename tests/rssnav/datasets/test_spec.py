"""A spec is read whole or refused, with the file, the key, and what is expected."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_datasets import SPEC, edited, spec_of

import floorplans
from raytrace import TraceConfig
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.spec import builtin_specs, load_spec
from rssnav.datasets.split import SPLITS, Fractions
from rssnav.presets import PRESETS

WRONG = {
    'name = "small"': ('nam = "small"', "unknown key nam: did you mean name"),
    "seeds = 3": ("seeds = 0", r"plans\[0\].seeds = 0, expected an integer from 1"),
    "area_m2 = 50": ("area_m2 = [90, 60]", r"area_m2 = \[90, 60\], expected a number, or"),
    'kind = "flat"': ('kind = "tent"', "kind = 'tent', expected one of flat, office"),
    "count = 2": ("count = 0", "transmitters.count = 0, expected an integer from 1"),
    "[2.4, 5.2]": ("[2.4, 2.4]", r"frequencies_ghz = \[2.4, 2.4\], expected a list of different"),
    'antennas = ["isotropic"]': ('antennas = ["x"]', "expected isotropic, unpolarised"),
    "cell_size_m = 2.0": ("cell_size_m = nan", "cell_size_m = nan, expected a number from 0.05"),
    "reflections = 1": ("reflections = 99", r"\[presets.quick\]: max_reflections = 99"),
    "transmissions = 1": (
        'transmissions = "x"',
        "transmissions = 'x', expected a number or 'none'",
    ),
    "[presets.quick]": ("[presets.quick]\nbase = 'no'", "base = 'no', expected one of paper"),
    "[receivers]": ("[receiver]", "unknown key receiver: did you mean receivers"),
}


@pytest.mark.parametrize("old", WRONG)
def test_a_wrong_spec_is_refused_by_file_and_key(old: str) -> None:
    new, message = WRONG[old]
    with pytest.raises(DatasetError, match=message) as caught:
        _ = spec_of(edited(old, new)).plans
    assert str(caught.value).startswith("spec.toml: ")


@pytest.mark.parametrize("key", ["area_m2 = 50", "cell_size_m = 2.0", "seeds = 3"])
def test_numbers_of_any_size_are_read(key: str) -> None:
    with pytest.raises(DatasetError, match="expected"):
        spec_of(edited(key, f"{key.partition('=')[0]}= 1{'0' * 400}"))


def test_a_spec_that_is_no_toml_is_refused() -> None:
    with pytest.raises(DatasetError, match=r"spec\.toml: not TOML"):
        spec_of("name = ")


def test_a_byte_order_mark_is_no_part_of_a_spec(tmp_path) -> None:
    path = tmp_path / "spec.toml"
    path.write_text(SPEC, encoding="utf-8-sig")
    assert load_spec(path).name == spec_of().name


def test_defaults_and_limits_are_those_of_the_presets() -> None:
    configuration = spec_of().configuration
    assert configuration.presets == {"quick": TraceConfig(1, 0, 1)}
    bare = spec_of('name = "a"\n[[plans]]\nkind = "flat"\nseeds = [5]').configuration
    assert bare.presets == {"building": PRESETS["building"].config}
    unlimited = edited("transmissions = 1", 'transmissions = "none"')
    limits = spec_of(unlimited).configuration.presets["quick"]
    assert (limits.max_transmissions, limits.min_power_dbm) == (None, -120.0)


def test_the_key_holds_what_maps_depend_on() -> None:
    texts = [
        SPEC,
        edited("[2.4, 5.2]", "[2.4]"),
        edited("cell_size_m = 2.0", "cell_size_m = 1.0"),
        edited("reflections = 1", "reflections = 2"),
        f'{SPEC}\n[keep]\nlayers = ["rss_dbm"]',
        f"{SPEC}\n[keep]\nstrongest_paths = 2",
    ]
    assert len({spec_of(text).configuration.key for text in texts}) == len(texts)
    renamed = edited('name = "small"', 'name = "other"')
    assert spec_of(renamed).configuration.key == spec_of().configuration.key


@given(st.integers(1, 40), st.integers(0, 10), st.lists(st.integers(0, 5), min_size=3, max_size=3))
def test_each_split_has_its_fraction_of_the_buildings(n: int, seed: int, weights) -> None:
    if not any(weights):
        return
    fractions = Fractions(dict(zip(SPLITS, weights, strict=True)), seed)
    buildings = [f"building {k}" for k in range(n)]
    found = fractions.of(buildings)
    assert found == fractions.of(buildings[::-1])
    assert set(found) == set(buildings)
    for split, weight in zip(SPLITS, weights, strict=True):
        wanted = n * weight / sum(weights)
        assert abs(sum(of == split for of in found.values()) - wanted) <= 1.0


def test_a_building_in_two_splits_is_refused(tmp_path) -> None:
    plan = floorplans.dumps(floorplans.load("flat"))
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
    (tmp_path / "one" / "a.toml").write_text(plan)
    (tmp_path / "two" / "b.toml").write_text(plan.replace('name = "', 'name = "other ', 1))
    text = 'name = "s"\n' + "".join(
        f'[[plans]]\nfolder = "{folder}"\nsplit = "{split}"\n'
        for folder, split in (("one", "train"), ("two", "test"))
    )
    with pytest.raises(
        DatasetError, match="'a' and 'b' are the same building, listed in train and"
    ):
        _ = spec_of(text, tmp_path).plans
    twice = "[[plans]]\nkind='flat'\nseeds=3\nsplit='train'\n[[plans]]\nkind='flat'\nseeds=[2]\n"
    with pytest.raises(
        DatasetError, match=r"'flat-000002' and 'flat-000002' .* in train and in test"
    ):
        _ = spec_of(f"name='s'\n{twice}split='test'\n").plans
    with pytest.raises(DatasetError, match=r"plans\[1\] names no split, but others do"):
        spec_of(f"name='s'\n{twice}")


def test_a_folder_without_plans_is_refused(tmp_path) -> None:
    with pytest.raises(DatasetError, match=r"none: no plans: expected a folder with \.toml files"):
        _ = spec_of('name = "s"\n[[plans]]\nfolder = "none"', tmp_path).plans


def test_plans_do_not_depend_on_the_list_they_are_in() -> None:
    few = spec_of(edited("area_m2 = 50", "area_m2 = [50, 90]").replace("seeds = 3", "seeds = [2]"))
    many = spec_of(edited("area_m2 = 50", "area_m2 = [50, 90]"))
    assert few.plans[0].described == many.plans[2].described


@pytest.mark.parametrize("name", builtin_specs())
def test_built_in_specs_can_be_read(name: str) -> None:
    assert load_spec(name).plans
