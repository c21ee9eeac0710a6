"""A study that was killed continues, and gives what it gives without a break."""

from collections import Counter
from dataclasses import replace

import pytest

from rssnav.experiments.studies import STUDIES, run_study
from rssnav.experiments.studies.comparison.methods import Learners
from rssnav.experiments.studies.noise import measuring
from rssnav.experiments.studies.sensitivity import alternatives
from rssnav.experiments.training_store import TrainingStore

PIECES = {
    "noise": lambda piece: piece.rule == "intervals" and piece.width_db == 4.0,
    "sensitivity": lambda piece: piece.key.speed == 1 and piece.key.agent == "location",
    "comparison": lambda piece: (
        (piece.scenario, piece.speed) == (1, 1) and isinstance(piece.contender, Learners)
    ),
}


@pytest.fixture(params=PIECES)
def study(request, monkeypatch):
    """A study that trains, with few and short trainings."""
    monkeypatch.setattr(measuring, "SPEED", 1)
    monkeypatch.setattr(measuring, "EPISODES", 50)
    monkeypatch.setattr(alternatives, "STEP_LIMIT", 20_000)
    whole = STUDIES[request.param]
    return replace(whole, pieces=tuple(filter(PIECES[whole.name], whole.pieces))[:4])


class Trained:
    """Counts the trainings that are not reused, by name; the process is killed after the most."""

    def __init__(self, monkeypatch):
        self.counts, self.most = Counter(), None
        monkeypatch.setattr(TrainingStore, "train", self._counting(TrainingStore.train))

    def _counting(self, train):
        def counted(store, name, *args, **kwargs):
            if self.most == self.counts.total():
                raise SystemExit
            result, trained = train(store, name, *args, **kwargs)
            self.counts[name] += trained
            return result, trained

        return counted


def test_a_killed_study_continues_with_the_same_results(study, small_study, monkeypatch):
    trained = Trained(monkeypatch)
    expected = run_study(study, small_study / "whole", quick=True)
    names = set(trained.counts)
    trained.counts.clear()
    trained.most = 2
    with pytest.raises(SystemExit):
        run_study(study, small_study / "killed", quick=True)
    trained.most = None
    found = run_study(study, small_study / "killed", quick=True)
    assert trained.counts == dict.fromkeys(names, 1)
    for one, other in zip(expected.files, found.files, strict=True):
        assert one.read_bytes() == other.read_bytes() or one.suffix == ".png"
    run_study(study, small_study / "killed", quick=True, resume=False)
    assert trained.counts == dict.fromkeys(names, 2)


@pytest.mark.parametrize("name", ["noise", "sensitivity"])
def test_each_training_has_a_file_of_its_own(name):
    names = {
        "noise": lambda piece: piece.name,
        "sensitivity": lambda piece: f"{piece.alternative.label} {piece.key.name}",
    }
    pieces = STUDIES[name].pieces
    files = {TrainingStore.file_name(names[name](piece)) for piece in pieces}
    assert len(files) == len(pieces)
