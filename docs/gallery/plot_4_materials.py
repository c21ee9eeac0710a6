"""
How walls reflect
=================

A wall reflects as a slab of its material and thickness (Recommendation ITU-R P.2040). The
reflections of its two faces interfere, so a thin pane may reflect more than a thick wall. The
coefficient depends on the angle and on the polarisation.
"""

import matplotlib.pyplot as plt
import numpy as np

from raytrace.radio.materials import Slab
from rssnav.pictures.style import PAGE_IN, STYLE

plt.rcParams.update(STYLE)

slabs = {
    "concrete, 20 cm": Slab.of("concrete", 0.2),
    "brick, 30 cm": Slab.of("brick", 0.3),
    "plasterboard, 10 cm": Slab.of("plasterboard", 0.1),
    "glass, 2 cm": Slab.of("glass", 0.02),
    "wood, 5 cm": Slab.of("wood", 0.05),
}

# %%
# At 2.4 GHz, over the angle from the normal. For vertical polarisation and horizontal rays, walls
# reflect with TE, where the electric field is perpendicular to the plane of incidence; floor and
# ceiling reflect with TM.
angle_deg = np.linspace(0.0, 89.9, 600)
cosine = np.cos(np.radians(angle_deg))

figure, panels = plt.subplots(1, 2, figsize=(PAGE_IN, 2.4), sharey=True, layout="constrained")
for name, slab in slabs.items():
    found = slab.material.coefficients(slab.thickness_m, 2.4e9, cosine)
    for ax, reflected in zip(panels, (found.r_te, found.r_tm), strict=True):
        ax.plot(angle_deg, 20.0 * np.log10(np.abs(reflected)), label=name)
for ax, title in zip(panels, ("TE", "TM: minimum near Brewster's angle"), strict=True):
    ax.set_title(title)
    ax.set_xlabel("angle of incidence [deg]")
    ax.set_ylim(-40.0, 0.0)
panels[0].set_ylabel("reflection [dB]")
panels[0].legend(loc="lower right")
plt.show()

# %%
# Over frequency, at normal incidence: the ripples come from the interference of the two faces.
frequency_hz = np.linspace(1e9, 10e9, 500)
figure, ax = plt.subplots(figsize=(PAGE_IN, 2.2), layout="constrained")
for name, slab in slabs.items():
    reflected = [
        slab.material.coefficients(slab.thickness_m, f, np.array([1.0])).r_te[0]
        for f in frequency_hz
    ]
    ax.plot(frequency_hz * 1e-9, 20.0 * np.log10(np.abs(reflected)), label=name)
ax.set_xlabel("frequency [GHz]")
ax.set_ylabel("reflection [dB]")
ax.set_ylim(-40.0, 0.0)
ax.legend(ncols=3, loc="lower right")
plt.show()
