"""Transmitters of plans become those of the tracer; what a plan leaves open is filled in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cli_plans import ROOM

import floorplans
from floorplans import PlanTransmitter
from raytrace import (
    AntennaError,
    HalfWaveDipole,
    Isotropic,
    PatternTable,
    TraceConfig,
    Transmitter,
    TransmitterMaps,
    compute_radio_maps,
)
from raytrace.radio.rotated import Rotated
from rssnav.maps import make_map
from rssnav.scenes import scene_of
from rssnav.transmitter_maps import make_transmitter_maps
from rssnav.transmitters import NoTransmitterError, Sending, antenna_of, choose_transmitters

SENDER = PlanTransmitter("east", (5.0, 3.0, 2.0), 12.0, 5.2e9, "dipole", (1.0, 0.0, 0.0))
BARE = PlanTransmitter("west", (1.0, 3.0, 2.5))
PLAN = replace(floorplans.loads(ROOM), transmitters=(SENDER, BARE))
ALONE = replace(PLAN, source=None, start=None)
QUICK = TraceConfig(1, 0, 1)


def test_the_plan_counts_before_the_defaults_and_the_caller_before_the_plan() -> None:
    found = choose_transmitters(PLAN, ["east", "west"])
    assert found["east"] == Transmitter(
        (5.0, 3.0, 2.0), 12.0, 5.2e9, HalfWaveDipole(axis=(1.0, 0.0, 0.0))
    )
    assert found["west"] == Transmitter((1.0, 3.0, 2.5))
    sending = Sending(3.0, 1e9, Isotropic(1.0))
    found = choose_transmitters(PLAN, ["all"], sending)
    for of_plan, one in zip((SENDER, BARE), found.values(), strict=True):
        assert one == Transmitter(of_plan.position, 3.0, 1e9, Isotropic(1.0))
    default = Sending(default_antenna=Isotropic(2.0))
    east, west = choose_transmitters(PLAN, ["all"], default).values()
    assert east.antenna == HalfWaveDipole(axis=(1.0, 0.0, 0.0))
    assert west.antenna == Isotropic(2.0)


def test_the_source_is_the_default_and_otherwise_all_transmitters() -> None:
    assert list(choose_transmitters(PLAN)) == ["source"]
    assert list(choose_transmitters(ALONE)) == ["east", "west"]
    found = choose_transmitters(ALONE, [(1.0, 2.5, 1.5), "west"])
    assert list(found) == ["1,2.5,1.5", "west"]
    assert found["1,2.5,1.5"].position == (1.0, 2.5, 1.5)


@pytest.mark.parametrize(
    ("plan", "names", "message"),
    [
        (replace(ALONE, transmitters=()), [], "neither a source nor transmitters"),
        (ALONE, ["source"], "no transmitter 'source': it has east, west"),
        (PLAN, ["north"], "no transmitter 'north': it has east, west, source"),
        (replace(ALONE, transmitters=()), ["all"], "no transmitter 'all': it has none"),
    ],
)
def test_a_missing_transmitter_is_named_beside_those_there_are(plan, names, message) -> None:
    with pytest.raises(NoTransmitterError, match=message):
        choose_transmitters(plan, names)


def test_patterns_are_read_beside_the_plan_and_turned(tmp_path: Path) -> None:
    rows = [(t, p, -t / 90.0) for t in (0, 90, 180) for p in (0, 180, 360)]
    text = "\n".join(["theta_deg,phi_deg,gain_dbi", *(f"{t},{p},{g}" for t, p, g in rows)])
    (tmp_path / "patch.csv").write_text(text)
    pattern = PatternTable.from_csv(tmp_path / "patch.csv")
    assert antenna_of("patch.csv", None, tmp_path) == pattern
    turned = antenna_of("patch.csv", (0.0, -1.0, 0.0), tmp_path)
    assert turned == Rotated.towards(pattern, (0.0, -1.0, 0.0))
    with pytest.raises(AntennaError, match=r"missing\.csv: the file cannot be read"):
        antenna_of("missing.csv", None, tmp_path)


def test_maps_of_several_transmitters_are_those_of_each(tmp_path: Path) -> None:
    plan, transmitters = ALONE, choose_transmitters(ALONE)
    notices: list[str] = []
    progress: list[tuple[int, int]] = []
    path = tmp_path / "maps.h5"

    def make(**options) -> TransmitterMaps:
        return make_transmitter_maps(
            plan, transmitters, path, config=QUICK, notice=notices.append,
            progress=lambda *parts: progress.append(parts), **options,
        )  # fmt: skip

    maps = make(receive_antenna=Isotropic())
    assert progress[-1] == (2000, 2000)
    assert progress == sorted(progress)
    for name, transmitter in transmitters.items():
        alone = make_map(plan, transmitter=transmitter, receive_antenna=Isotropic(), config=QUICK)
        np.testing.assert_array_equal(maps[name].rss_dbm, alone.rss_dbm)
        assert maps[name].plan_sha256 == plan.sha256
    scene = scene_of(plan)
    grid = maps.first.grid
    traced = compute_radio_maps(scene, transmitters, grid, QUICK, receive_antenna=Isotropic())
    inside = np.isfinite(maps.total_dbm)
    np.testing.assert_array_equal(traced.total_dbm[inside], maps.total_dbm[inside])
    assert make(receive_antenna=Isotropic()).names == ("east", "west")
    assert notices == [f"{path} is up to date"]
    make()
    assert notices[1] == f"{path} was made for a different receive antenna; recomputing it"
