"""What an engine does: a list of plans in, their summaries out, as they are done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from rssnav.datasets.configuration import Configuration
from rssnav.datasets.plans import PlanSource
from rssnav.datasets.work import Summary


@dataclass(frozen=True)
class Job:
    """Plans that are to be traced.

    Attributes
    ----------
    sources
        The plans.
    configuration
        What is traced in each.
    folder
        Where their files go.
    finished
        Called with the summary of each plan, on the calling thread.
    traced
        Called with the number of maps that have been traced since the last call, on the calling
        thread.
    """

    sources: Sequence[PlanSource]
    configuration: Configuration
    folder: Path
    finished: Callable[[Summary], None]
    traced: Callable[[int], None]

    def failed(self, source: PlanSource, error: BaseException) -> Summary:
        """Return the summary of a plan whose work was lost; a further run tries it again."""
        key = source.key(self.configuration.key)
        return Summary.of_failure(source, key, error, is_final=False)


class Engine(Protocol):
    """Traces plans; the files are the same whichever does.

    Attributes
    ----------
    n
        Plans that are traced at the same time.
    """

    n: int

    def run(self, job: Job) -> None:
        """Trace all plans of a job.

        Raises
        ------
        DatasetError, OSError
            Where no further plan can be traced or kept.
        """
        ...
