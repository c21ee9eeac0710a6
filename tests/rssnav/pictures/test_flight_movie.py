"""The film of a flight shows the flight, in the agent's colours, and says where it cannot."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from cli_plans import ROOM, done, room_file, run
from matplotlib.colors import to_rgb
from PIL import Image

import floorplans
from raytrace import TraceConfig
from rssnav import GridWorld, LocationAgent, ResultFileError, RssAgent, train
from rssnav.maps import make_map
from rssnav.pictures.flight_movie import FinalFlight, FlightScene, MovieError, save_flight_movie
from rssnav.pictures.style import AGENT_COLOURS


@pytest.fixture(scope="module")
def room():
    return floorplans.loads(ROOM)


@pytest.fixture(scope="module")
def radio_map(room):
    return make_map(room, config=TraceConfig(2, 1))


@pytest.fixture(scope="module")
def trained(room, radio_map):
    world = GridWorld.from_map(room, radio_map)
    agents = (RssAgent(terminal_dbm=-24.0), LocationAgent())
    return [train(world, agent, runs=3, episodes=300) for agent in agents]


def pixels_of(frame, agent: str) -> int:
    colour = np.rint(255 * np.array(to_rgb(AGENT_COLOURS[agent])))
    return int((np.abs(frame - colour).max(axis=-1) <= 4).sum())


def test_the_film_has_a_frame_a_step_and_the_agents_colours(room, radio_map, trained, tmp_path):
    told = []
    flights = save_flight_movie(
        room, radio_map, trained, tmp_path / "flight.gif", progress=lambda *n: told.append(n)
    )
    assert [flight.agent for flight in flights] == ["rss", "location"]
    assert told[-1][0] == told[-1][1] == len(told)
    with Image.open(tmp_path / "flight.gif") as film:
        assert film.n_frames == max(len(flight.position) for flight in flights)
        film.seek(film.n_frames - 1)
        last = np.asarray(film.convert("RGB")).astype(float)
    for agent in ("rss", "location"):
        assert pixels_of(last, agent) > 100
    assert [file.name for file in tmp_path.iterdir()] == ["flight.gif"]


def test_the_trail_grows_with_every_step(room, radio_map, trained):
    flight = FinalFlight.of(trained[0])
    scene = FlightScene(room, radio_map, [flight])
    grown = [pixels_of(scene.frame(step).astype(float), "rss") for step in range(4)]
    assert grown == sorted(grown)
    assert grown[-1] > grown[0]
    last, after = (scene.frame(scene.n_steps + k) for k in (0, 5))
    assert np.array_equal(last, after)


def test_a_flight_is_that_of_its_run(trained):
    result = trained[0]
    flight = FinalFlight.of(result, run=2)
    assert np.array_equal(flight.position, result.trajectory_m(2))
    assert flight.length_m == result.path_length_m[2]
    assert flight.rss_dbm.shape == (len(flight.position),)
    with pytest.raises(MovieError, match="run 3: the training has runs 0 to 2"):
        FinalFlight.of(result, run=3)


def test_formats_that_cannot_be_written_are_refused(room, radio_map, trained, tmp_path):
    with pytest.raises(MovieError, match=r"use one of \.gif, \.mp4"):
        save_flight_movie(room, radio_map, trained, tmp_path / "flight.avi")
    if shutil.which("ffmpeg") is None:
        with pytest.raises(MovieError, match=r"needs the program ffmpeg.*flight\.gif instead"):
            save_flight_movie(room, radio_map, trained, tmp_path / "flight.mp4")
    else:
        save_flight_movie(room, radio_map, trained, tmp_path / "flight.mp4")
        assert b"ftyp" in (tmp_path / "flight.mp4").read_bytes()[:16]


def test_a_training_of_another_plan_is_refused(room, radio_map, trained, tmp_path):
    with pytest.raises(ResultFileError, match="is for a different plan"):
        save_flight_movie(floorplans.load("flat"), radio_map, trained, tmp_path / "flight.gif")


def test_the_command_makes_the_film(tmp_path):
    plan, radio_map, training = room_file(tmp_path), tmp_path / "room.h5", tmp_path / "rss.h5"
    done("map", plan, "-o", radio_map)
    agent = ("--agent", "location", "--runs", 1, "--episodes", 200)
    done("train", plan, "--map", radio_map, *agent, "-o", training)
    film = tmp_path / "flight.gif"
    facts = json.loads(
        done("fly", plan, training, "--map", radio_map, "-o", film, "--style", "ggplot", "--json")
    )
    assert facts["flights"][0]["agent"] == "location"
    assert film.read_bytes().startswith(b"GIF89a")
    refused = run("fly", plan, training, "--map", radio_map, "-o", film, "--run", 4)
    assert refused.exit_code == 1
    assert refused.stderr == "rssnav: run 4: the training has runs 0 to 0\n"
