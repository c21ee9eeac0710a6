"""
Power delay profile
===================

Every path to a receiver has a delay and a power: the power delay profile. A receiver of limited
bandwidth cannot resolve paths that arrive close together; it samples their sum.
"""

import matplotlib.pyplot as plt
import numpy as np

import floorplans
import raytrace
from rssnav import scene_of
from rssnav.pictures.style import PAGE_IN, STYLE

plt.rcParams.update(STYLE)

plan = floorplans.load("flat")
transmitter = raytrace.Transmitter(plan.source)
receiver = np.array([[*plan.start, 2.0]])
paths = raytrace.trace_paths(scene_of(plan), transmitter, receiver)

# %%
# How much of the power do the strongest paths carry?
power = np.abs(paths.gain) ** 2
for n in (1, 10, 100, len(paths)):
    print(
        f"the strongest {n:5d} of {len(paths)}: {power[:n].sum() / power.sum():6.1%} of the power"
    )

mean_s = np.average(paths.delay_s, weights=power)
spread_s = np.sqrt(np.average((paths.delay_s - mean_s) ** 2, weights=power))
print(f"RMS delay spread: {spread_s * 1e9:.1f} ns")

# %%
# Paths with and without a diffraction, and the impulse response in a band of 160 MHz.
power_dbm = transmitter.power_dbm + paths.gain_db
diffracted = (paths.interactions == 2).any(axis=1)
channel = paths.impulse_response(160e6)

figure, ax = plt.subplots(figsize=(PAGE_IN, 2.8), layout="constrained")
for chosen, colour, label in (
    (~diffracted, "#009e73", "reflected"),
    (diffracted, "#cc79a7", "diffracted once, and reflected"),
):
    ax.plot(paths.delay_s[chosen] * 1e9, power_dbm[chosen], ".", ms=2, color=colour, label=label)
taps_dbm = transmitter.power_dbm + 20.0 * np.log10(np.abs(channel.taps[0]))
ax.plot(channel.delay_s * 1e9, taps_dbm, "k.-", lw=0.8, ms=4, label="in 160 MHz")
ax.set_xlabel("delay [ns]")
ax.set_ylabel("power [dBm]")
ax.set_xlim(20.0, 160.0)
ax.set_ylim(-150.0, -40.0)
ax.legend()
plt.show()
