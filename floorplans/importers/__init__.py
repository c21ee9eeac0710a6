"""Plans from other programs' files: DXF, GeoJSON and IMDF, ROS map_server, IFC.

>>> from floorplans.importers import import_plan
>>> imported = import_plan("office.dxf")  # doctest: +SKIP
>>> imported.plan.bounds  # doctest: +SKIP
(0.0, 0.0, 57.9, 27.9)

A reader for each format turns its file into a `Draft`; `assemble` makes the walls meet, attaches
doors and windows to them, finds the outline and gives a default to what the file does not state.
`Imported` holds the plan and lists what was assumed and changed. A plan that fails its checks is
the `DraftPlan` of an `UnusablePlanError`.
"""

from floorplans.importers.assembly.assemble import assemble
from floorplans.importers.draft import (
    Assumption,
    Draft,
    ImportOptions,
    LayerUse,
    Origin,
    RawOpening,
    RawWall,
)
from floorplans.importers.formats import FORMATS, import_plan, read_draft
from floorplans.importers.imported import (
    DraftPlan,
    DrawingPart,
    Imported,
    ImportRecord,
    UnusablePlanError,
)
from floorplans.importers.layer_file import layers_toml, read_layers
from floorplans.importers.page import import_page

__all__ = [
    "FORMATS",
    "Assumption",
    "Draft",
    "DraftPlan",
    "DrawingPart",
    "ImportOptions",
    "ImportRecord",
    "Imported",
    "LayerUse",
    "Origin",
    "RawOpening",
    "RawWall",
    "UnusablePlanError",
    "assemble",
    "import_page",
    "import_plan",
    "layers_toml",
    "read_draft",
    "read_layers",
]
