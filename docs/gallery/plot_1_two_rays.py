"""
Two rays over a conducting floor
================================

Over flat ground two rays reach a receiver: the direct one and the ground reflection. Their sum
fades where they cancel. Beyond the last maximum, the power falls with the fourth power of the
distance. This hall has absorbing walls and an absorbing ceiling, so only these two rays
remain, and the tracer must agree with the formula.
"""

import matplotlib.pyplot as plt
import numpy as np

import floorplans
import raytrace
from rssnav import scene_of
from rssnav.pictures.style import COLUMN_IN, STYLE

plt.rcParams.update(STYLE)

plan = floorplans.loads("""
name = "hall"
format = 1
height_m = 20
floor_material = "perfect_conductor"
ceiling_material = "absorber"
source = [5, 10, 3]
start = [10.5, 10.5]
outline = [[0, 0], [600, 0], [600, 20], [0, 20], [0, 0]]

[[walls]]
points = [[0, 0], [600, 0], [600, 20], [0, 20], [0, 0]]
material = "absorber"
thickness_m = 0.1
""")

# %%
# Trace to receivers 1.5 m above the floor, at distances from 5 m to 580 m. Isotropic antennas
# keep the formula short.
distance_m = np.geomspace(5.0, 580.0, 1500)
height_m = 1.5
receivers = np.column_stack(
    [plan.source[0] + distance_m, np.full(1500, plan.source[1]), np.full(1500, height_m)]
)
transmitter = raytrace.Transmitter(plan.source, antenna=raytrace.Isotropic())
paths = raytrace.trace_paths(
    scene_of(plan),
    transmitter,
    receivers,
    raytrace.TraceConfig(1, 0),
    receive_antenna=raytrace.Isotropic(),
)
field = np.zeros(distance_m.size, complex)
np.add.at(field, paths.receiver, paths.gain)

# %%
# The formula: the ground reflects vertical polarisation with the coefficient +1. Both antennas are
# isotropic along the vertical polarisation of each ray, so no further projection is needed.
k = 2.0 * np.pi / transmitter.wavelength_m
direct_m = np.hypot(distance_m, plan.source[2] - height_m)
reflected_m = np.hypot(distance_m, plan.source[2] + height_m)
two_rays = np.exp(-1j * k * direct_m) / direct_m + np.exp(-1j * k * reflected_m) / reflected_m
two_rays *= transmitter.wavelength_m / (4.0 * np.pi)

worst_db = np.max(np.abs(20.0 * np.log10(np.abs(field) / np.abs(two_rays))))
print(f"maximum difference between tracer and formula: {worst_db:.4f} dB")

# %%
figure, ax = plt.subplots(figsize=(COLUMN_IN, 2.6), layout="constrained")
ax.semilogx(distance_m, 20.0 * np.log10(np.abs(field)), label="tracer")
ax.semilogx(distance_m, 20.0 * np.log10(np.abs(two_rays)), "k:", label="two-ray formula")
free_space = transmitter.wavelength_m / (4.0 * np.pi * direct_m)
ax.semilogx(distance_m, 20.0 * np.log10(free_space), color="0.6", label="free space")
ax.set_xlabel("distance [m]")
ax.set_ylabel("path gain [dB]")
ax.legend()
plt.show()
