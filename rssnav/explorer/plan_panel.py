"""Choose or upload a floor plan."""

from typing import Any

import panel as pn

import floorplans
from rssnav.explorer.import_worker import SESSION
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS, details
from rssnav.explorer.survey_layer import CSV, EXAMPLE
from rssnav.explorer.uploads import ACCEPTED

_DRAWINGS = ", ".join(suffix for suffix in ACCEPTED if suffix != SESSION)
_UPLOAD = f"Or upload a plan ({_DRAWINGS}), a survey ({CSV}) or a session ({SESSION})"


class PlanDropper(pn.widgets.FileDropper):
    """A drop area that keeps the newest file only, and none that comes in several messages."""

    def _process_event(self, event: Any) -> None:
        self.value.clear()
        self.mime_type.clear()
        if event.event_name == "delete_event" or event.data["total_chunks"] == 1:
            super()._process_event(event)


class PlanPanel:
    """Widgets for the floor plan.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._showing = False
        self._plan = pn.widgets.Select(
            label="Floor plan",
            options=self._names(),
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
        )
        self._upload = pn.Column(self._dropper(), sizing_mode="stretch_width", margin=0)
        self._report = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self._plan.param.watch(self._choose, "value")
        self.view = pn.Column(
            self._plan,
            self._upload,
            self._report,
            sizing_mode="stretch_width",
        )
        self.show()

    def show(self) -> None:
        """Show the session's plan."""
        self._showing = True
        plan = self._session.plan
        self._plan.options = self._names()
        self._plan.value = plan.name
        self._report.object = details("Import report", self._session.import_report)
        self._report.visible = bool(self._session.import_report)
        self._showing = False

    def empty_upload(self) -> None:
        """Show an empty dropper: only a new one forgets the last file in the browser."""
        self._upload[:] = [self._dropper()]

    def _dropper(self) -> PlanDropper:
        limits = self._session.limits
        dropper = PlanDropper(
            label=_UPLOAD,
            multiple=False,
            max_file_size=f"{limits.upload_bytes // 1000}KB",
            chunk_size=2 * limits.upload_bytes,
            previews=[],
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
        )
        dropper.param.watch(self._take, "value")
        return dropper

    def _names(self) -> list[str]:
        """Built-in plans, the example and the open plan."""
        known = (*floorplans.builtin_names(), EXAMPLE, self._session.plan.name)
        return list(dict.fromkeys(known))

    def _choose(self, event: Any) -> None:
        if not self._showing and event.new in floorplans.builtin_names():
            self._session.open_builtin(event.new)
        elif not self._showing and event.new == EXAMPLE:
            self._session.open_example()

    def _take(self, event: Any) -> None:
        """Hand an uploaded file to the session."""
        for name, content in event.new.items():
            data = content.encode() if isinstance(content, str) else content
            self._session.upload(name, data)
