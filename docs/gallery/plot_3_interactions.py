"""
Contribution of each interaction
================================

The map of the built-in flat: line of sight only, then with up to six reflections, then also with
one diffraction. Hatched cells have no path.
"""

import matplotlib.pyplot as plt
import numpy as np

import floorplans
from raytrace import TraceConfig
from rssnav.maps import make_map
from rssnav.pictures.radio_map import draw_radio_map
from rssnav.pictures.style import PAGE_IN, STYLE

plt.rcParams.update(STYLE)
plan = floorplans.load("flat")

# %%
# Cells of half a metre, 2 m above the floor. ``make_map`` returns a map, and writes it to a file if
# one is given.
limits = {
    "line of sight": TraceConfig(0, 0),
    "and 6 reflections": TraceConfig(6, 0),
    "and 1 diffraction": TraceConfig(6, 1),
}
maps = {what: make_map(plan, cell_size_m=0.5, config=limit) for what, limit in limits.items()}

for what, radio_map in maps.items():
    covered = np.isfinite(radio_map.rss_dbm).mean()
    print(f"{what:18} {radio_map.path_count.sum():7d} paths, {covered:4.0%} of the cells have one")

# %%
figure, panels = plt.subplots(1, 3, figsize=(PAGE_IN, 2.1), sharey=True, layout="constrained")
for ax, (what, radio_map) in zip(panels, maps.items(), strict=True):
    image = draw_radio_map(plan, radio_map, ax, rss_range_dbm=(-80.0, -20.0))
    ax.set_title(what)
for ax in panels[1:]:
    ax.set_ylabel("")
figure.colorbar(image, ax=panels, label="RSS [dBm]", extend="both")
plt.show()

# %%
# The bathroom's door is closed, so no path enters: by default, transmission through walls is not
# traced.
