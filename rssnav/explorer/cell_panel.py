"""The strongest paths to the selected cell: a table, their delay profile, a file of all."""

from collections.abc import Callable
from typing import Any

import panel as pn

from raytrace.results.csv_file import write_csv
from rssnav.explorer.cell_paths import TOP, CellPaths, path_colours
from rssnav.explorer.delay_profile import DelayProfile
from rssnav.explorer.file_buttons import file_button, written
from rssnav.explorer.file_names import file_name
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS, decibels, degrees, pairs, problem, thousands

_INVITATION = (
    '<p class="quiet">Click a cell of the map, or move to one with the arrow keys, to see its '
    "strongest paths.</p>"
)
_NO_PATH = "<p>No path reaches this cell.</p>"
DELAYS, ANGLES = "Power and delay", "Phase and angles"


class CellPanel:
    """Table of the strongest paths, their delay profile, and a button for a file of all.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._facts, self._table = (
            pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width") for _ in range(2)
        )
        self._columns = pn.widgets.RadioButtonGroup(
            options=[DELAYS, ANGLES], value=DELAYS, stylesheets=WIDGETS, visible=False,
            sizing_mode="stretch_width",
        )  # fmt: skip
        self._columns.param.watch(self._choose_columns, "value")
        self._profile = DelayProfile()
        self._file = file_button(session, "Paths (CSV)", self._csv)
        self.view = pn.Column(
            self._facts,
            self._columns,
            self._table,
            pn.pane.Bokeh(self._profile.model, sizing_mode="stretch_width"),
            self._file,
            sizing_mode="stretch_width",
        )
        self.show()

    def show(self) -> None:
        """Show the session's newest paths."""
        finder = self._session.paths
        found = None if finder.problem else finder.latest
        has_paths = found is not None and len(found.paths) > 0
        self._columns.visible = has_paths
        self._facts.object = _summary(found) if found is not None else self._words()
        self._table.object = _table(found, self._columns.value) if found is not None else ""
        self._profile.show(found)
        self._file.disabled = not has_paths
        self._file.filename = file_name(f"{self._session.plan.name} paths", ".csv")

    def _choose_columns(self, _event: Any) -> None:
        self.show()

    def _words(self) -> str:
        """HTML of why there are no paths to show."""
        finder = self._session.paths
        if finder.problem:
            return problem(finder.problem)
        return "<p>Tracing the paths ...</p>" if finder.busy else _INVITATION

    def _csv(self) -> bytes:
        """CSV of the paths to the selected cell; nothing while there are none."""
        found, most = self._session.paths.latest, self._session.limits.csv_rows
        if found is None:
            return b""
        return written("paths.csv", lambda path: write_csv(path, found.columns(most)))


def _summary(found: CellPaths) -> str:
    x, y, z = found.receiver
    spread_s = float(found.statistics.delay_spread_s[0])
    return pairs(
        [
            ("cell", f"({x:g}, {y:g}, {z:g}) m"),
            ("RSS", decibels(float(found.statistics.rss_dbm[0]))),
            ("paths", thousands(int(found.statistics.path_count[0]))),
            ("delay spread", f"{1e9 * spread_s:.1f} ns"),
        ]
    )


def _table(found: CellPaths, columns: str) -> str:
    """HTML of a table of the strongest paths, strongest first."""
    top = min(TOP, len(found.paths))
    if not top:
        return _NO_PATH
    head, cells, note = (_angles if columns == ANGLES else _delays)(found)
    colours = path_colours(found.power_dbm[:top])
    rows = [
        f'<tr><td><i class="swatch" style="background:{colours[k]}"></i>{k + 1}</td>'
        + "".join(f"<td>{text}</td>" for text in cells(k))
        + "</tr>"
        for k in range(top)
    ]
    kind = "angles" if columns == ANGLES else "delays"
    return (
        f'<table class="paths {kind}"><thead>{head}</thead><tbody>{"".join(rows)}</tbody></table>'
        f'<p class="quiet">{note}</p>'
    )


Cells = Callable[[int], tuple[str, ...]]


def _delays(found: CellPaths) -> tuple[str, Cells, str]:
    """Head, cells of a path, and a note: power, length, delay, interactions."""
    paths, power_dbm = found.paths, found.power_dbm

    def cells(k: int) -> tuple[str, ...]:
        length, delay = f"{paths.length_m[k]:.2f}", f"{1e9 * paths.delay_s[k]:.1f}"
        return decibels(power_dbm[k], ""), length, delay, paths.sequence(k)

    heads = ("path", "power [dBm]", "length [m]", "delay [ns]", "interactions")
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    note = "R reflection, D diffraction, T transmission, LOS line of sight"
    return f"<tr>{head}</tr>", cells, note


def _angles(found: CellPaths) -> tuple[str, Cells, str]:
    """Head, cells of a path, and a note: phase, directions of departure and arrival."""
    phase, departure, arrival = found.phase_deg, found.departure_deg, found.arrival_deg

    def cells(k: int) -> tuple[str, ...]:
        shown = "?" if phase is None else degrees(phase[k])
        return shown, *map(degrees, departure[k]), *map(degrees, arrival[k])

    note = (
        "Departure from the transmitter; arrival: where the path comes from, seen from the "
        "receiver. az.: azimuth from +x towards +y; el.: elevation above the horizontal."
    )
    if phase is None:
        note += " The phase is unknown, because the polarisation of an antenna is."
    return _HEAD_OF_ANGLES, cells, note


_TWO = ("az.", "el.")
_HEAD_OF_ANGLES = (
    '<tr><th rowspan="2" scope="col">path</th><th rowspan="2" scope="col">phase [\u00b0]</th>'
    '<th colspan="2" scope="colgroup">departure [\u00b0]</th>'
    '<th colspan="2" scope="colgroup">arrival [\u00b0]</th></tr>'
    "<tr>" + "".join(f'<th scope="col">{name}</th>' for name in 2 * _TWO) + "</tr>"
)
