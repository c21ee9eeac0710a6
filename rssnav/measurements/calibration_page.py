"""The page on a calibration: self-contained HTML."""

from __future__ import annotations

from matplotlib.figure import Figure

from floorplans import FloorPlan
from rssnav.measurements.calibrate import Calibration
from rssnav.measurements.doors import CLEAR
from rssnav.measurements.pages import data_url, render, trace_assumptions
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import TraceSettings
from rssnav.pictures.style import COLUMN_IN, FAINT, SOURCE, styled


def calibration_page(
    plan: FloorPlan, survey: Survey, found: Calibration, settings: TraceSettings
) -> str:
    """Return the page's HTML."""
    rows = [
        {
            "material": value.material,
            "kind": value.kind,
            "unit": value.unit,
            "before": f"{value.quantity(value.prior):.3g}",
            "after": f"{value.quantity(fitted):.3g}",
            "low": f"{value.quantity(fitted - 2.0 * deviation):.3g}",
            "high": f"{value.quantity(fitted + 2.0 * deviation):.3g}",
        }
        for value, fitted, deviation in found.rows()
    ]
    return render(
        "calibration.html.j2",
        title=f"{plan.name}: materials fitted to measured RSS",
        found=found,
        rows=rows,
        clear=f"{CLEAR:g}",
        curve=data_url(curve_figure(found)) if found.curve else None,
        assumptions=trace_assumptions(plan, survey, settings),
    )


@styled
def curve_figure(found: Calibration) -> Figure:
    """Plot sigma at all other places over the number of places that are fitted to."""
    figure = Figure((COLUMN_IN, 2.4), layout="constrained")
    ax = figure.add_subplot()
    places = [point.n_places for point in found.curve]
    before = [point.before_db for point in found.curve]
    after = [point.after_db for point in found.curve]
    ax.plot(places, before, "o-", color=FAINT, label="offset fitted")
    ax.plot(places, after, "o-", color=SOURCE, label="offset and materials fitted")
    ax.set_xscale("log")
    ax.set_xticks(places, [str(n) for n in places])
    ax.minorticks_off()
    ax.set(xlabel="places that are fitted to", ylabel="sigma at all others [dB]")
    ax.legend()
    return figure
