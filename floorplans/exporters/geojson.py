"""FloorPlan -> GeoJSON that holds all of the plan; see `floorplans.geojson_plan`."""

from __future__ import annotations

from pathlib import Path

from floorplans.exporters.formats import ExportOptions, Files
from floorplans.geojson_plan import dumps_geojson
from floorplans.plan import FloorPlan


def render_geojson(plan: FloorPlan, path: Path, options: ExportOptions) -> Files:
    """Render a plan as one GeoJSON file; importing it restores an equal plan."""
    return {path.name: dumps_geojson(plan).encode()}
