"""The material tables against values published elsewhere, and their ranges of frequencies."""

import re

import pytest
from documents import ROOT

from raytrace.errors import SceneError
from raytrace.radio.itu import TABLES, Row
from raytrace.radio.materials import Dielectric, dielectrics_of, find_material


def permittivity(name: str, f_hz: float, edition: str = "P.2040-4") -> complex:
    material = find_material(name, edition)
    assert isinstance(material, Dielectric)
    return material.complex_permittivity(f_hz)


def conductivity(value: complex, f_ghz: float) -> float:
    """Eq. 12 of the Recommendation turned round: sigma = 0.05563 f eps''."""
    return -0.055_63 * f_ghz * value.imag


@pytest.mark.parametrize(
    ("name", "eps_r", "sigma"),
    [
        ("concrete", 5.31, 0.193_05),
        ("brick", 3.75, 0.038),
        ("plasterboard", 2.94, 0.054_914),
        ("wood", 1.99, 0.049_528),
        ("glass", 6.27, 0.059_075),
        ("ceiling_board", 1.5, 0.006_443_7),
        ("chipboard", 2.58, 0.120_44),
        ("metal", 1.0, 1e7),
    ],
)
def test_first_edition_at_9_ghz_as_mathworks_prints_it(
    name: str, eps_r: float, sigma: float
) -> None:
    value = permittivity(name, 9e9, "P.2040-1")
    assert value.real == pytest.approx(eps_r)
    assert conductivity(value, 9.0) == pytest.approx(sigma, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "eps_r", "sigma"),
    [
        ("concrete", 5.24, 0.257_66),
        ("brick", 3.91, 0.033_826),
        ("plasterboard", 2.73, 0.066_978),
        ("wood", 1.99, 0.049_528),
        ("glass", 6.31, 0.068_299),
    ],
)
@pytest.mark.parametrize("edition", ["P.2040-3", "P.2040-4"])
def test_third_and_fourth_edition_at_9_ghz_as_mathworks_prints_it(
    name: str, eps_r: float, sigma: float, edition: str
) -> None:
    value = permittivity(name, 9e9, edition)
    assert value.real == pytest.approx(eps_r)
    assert conductivity(value, 9.0) == pytest.approx(sigma, rel=1e-3)


@pytest.mark.parametrize("edition", TABLES)
def test_ranges_are_ranges(edition: str) -> None:
    for rows in TABLES[edition].values():
        assert all(0.0 < row.low_ghz < row.high_ghz <= 450.0 for row in rows)


def test_the_fourth_edition_goes_on_where_the_third_ends() -> None:
    third, fourth = TABLES["P.2040-3"], TABLES["P.2040-4"]
    assert all(fourth[name][: len(rows)] == rows for name, rows in third.items())
    assert set(fourth) - set(third) == {
        "clear_acrylic", "vinyl_tile", "carpet_tile", "asphalt_concrete",
    }  # fmt: skip


def test_a_range_is_chosen_by_frequency() -> None:
    assert permittivity("glass", 60e9).real == 6.31
    assert permittivity("glass", 300e9).real == 5.79
    assert permittivity("glass", 150e9).real == 6.5767


def test_ground_follows_its_power_law() -> None:
    assert permittivity("wet_ground", 4e9).real == pytest.approx(30.0 * 4.0**-0.4)


def test_vacuum_is_known_everywhere() -> None:
    assert permittivity("vacuum", 1.0) == permittivity("air", 1e13) == 1.0


@pytest.mark.parametrize(
    ("name", "edition", "f_ghz", "message"),
    [
        (
            "brick",
            "P.2040-1",
            24.0,
            "brick at 24 GHz: defined only for 1 to 10 GHz in ITU",
        ),
        (
            "brick",
            "P.2040-4",
            60.0,
            "only for 1 to 40 GHz, 110 to 330 GHz in ITU-R P.2040-4;",
        ),
        ("floorboard", "P.2040-4", 2.4, "floorboard at 2.4 GHz: defined only for 50 to"),
    ],
)
def test_outside_its_range_a_material_is_refused(
    name: str, edition: str, f_ghz: float, message: str
) -> None:
    with pytest.raises(SceneError) as caught:
        permittivity(name, f_ghz * 1e9, edition)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("name", "edition", "message"),
    [
        ("concret", "P.2040-4", "unknown material 'concret': did you mean 'concrete'?"),
        ("plywood", "P.2040-1", "ITU-R P.2040-1 has no 'plywood'"),
        ("glass", "P.2040-9", "no edition 'P.2040-9'"),
    ],
)
def test_unknown_names_are_refused(name: str, edition: str, message: str) -> None:
    with pytest.raises(SceneError) as caught:
        find_material(name, edition)
    assert message in str(caught.value)


def test_every_edition_has_vacuum_and_air() -> None:
    assert all({"vacuum", "air"} <= set(dielectrics_of(edition)) for edition in TABLES)


PAGE = (ROOT / "docs" / "materials.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| `(\w+)` \| (\S+) to (\S+) \| (\S+) \| (\S+) \| (\S+) \| (\S+) \|$", re.M)


def rows_on_page() -> list[tuple[str, Row]]:
    return [(name, Row(*map(float, numbers))) for name, *numbers in ROW.findall(PAGE)]


def test_page_shows_every_row_of_the_newest_edition_in_its_order() -> None:
    newest = [(n, row) for n, rows in TABLES["P.2040-4"].items() for row in rows if n != "vacuum"]
    assert rows_on_page()[: len(newest)] == newest


def test_page_shows_what_the_first_edition_has_otherwise() -> None:
    first, newest = TABLES["P.2040-1"], TABLES["P.2040-4"]
    other = [(n, row) for n, rows in first.items() for row in rows if row not in newest[n]]
    assert rows_on_page()[-len(other) :] == other


def test_python_example_of_the_page_runs(capsys) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    exec(example, {})
    assert capsys.readouterr().out.startswith("[")
