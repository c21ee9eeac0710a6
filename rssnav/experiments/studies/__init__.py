"""Studies beyond the paper: its open choices, RSS that fluctuates, other methods, printed lengths.

Each study is a package whose module ``study`` describes it as ``STUDY``;
:func:`~rssnav.experiments.studies.study.run_study` runs any of them.
"""

from typing import Any

from rssnav.experiments.studies.comparison import study as comparison
from rssnav.experiments.studies.noise import study as noise
from rssnav.experiments.studies.plan_search import study as plan_search
from rssnav.experiments.studies.readings import study as readings
from rssnav.experiments.studies.sensitivity import study as sensitivity
from rssnav.experiments.studies.study import Study, StudyResult, run_study

STUDIES: dict[str, Study[Any, Any]] = {
    study.name: study
    for study in (
        sensitivity.STUDY,
        noise.STUDY,
        comparison.STUDY,
        readings.STUDY,
        plan_search.STUDY,
    )
}
"""All studies, by name."""

__all__ = ["STUDIES", "Study", "StudyResult", "run_study"]
