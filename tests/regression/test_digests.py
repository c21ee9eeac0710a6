import json

import pytest
from regression.digests import FILE, MEASURED

REFERENCE = json.loads(FILE.read_text())


def test_every_digest_is_compared() -> None:
    assert REFERENCE.keys() == MEASURED.keys()


@pytest.mark.parametrize("name", MEASURED)
def test_results_are_those_of_the_reference(name) -> None:
    assert MEASURED[name]() == REFERENCE[name]
