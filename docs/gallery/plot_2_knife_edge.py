"""
Diffraction at the end of a wall
================================

Behind a wall the signal does not end at the shadow boundary. This wall is absorbing, so only the
diffracted field reaches its shadow. The classical solution for a thin absorbing screen
is Fresnel's integral (a *knife edge*, Recommendation ITU-R P.526). The tracer uses the uniform
theory of diffraction (UTD).
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import fresnel

import floorplans
import raytrace
from rssnav import scene_of
from rssnav.pictures.style import COLUMN_IN, STYLE

plt.rcParams.update(STYLE)

plan = floorplans.loads("""
name = "screen"
format = 1
height_m = 6
floor_material = "absorber"
ceiling_material = "absorber"
source = [5, 20, 3]
start = [60.5, 20.5]
outline = [[0, 0], [70, 0], [70, 40], [0, 40], [0, 0]]

[[walls]]
points = [[0, 0], [70, 0], [70, 40], [0, 40], [0, 0]]
material = "absorber"
thickness_m = 0.1

[[walls]]
points = [[30, 0], [30, 20]]
material = "absorber"
thickness_m = 0.1
""")

# %%
# Receivers on a line behind the wall, from deep in its shadow into the lit region.
y = np.linspace(12.0, 28.0, 801)
receivers = np.column_stack([np.full(y.size, 60.0), y, np.full(y.size, plan.source[2])])
transmitter = raytrace.Transmitter(plan.source, antenna=raytrace.Isotropic())
scene = scene_of(plan)


def field_of(max_diffractions: int) -> np.ndarray:
    """Sum of the paths' fields at each receiver."""
    paths = raytrace.trace_paths(
        scene,
        transmitter,
        receivers,
        raytrace.TraceConfig(0, max_diffractions),
        receive_antenna=raytrace.Isotropic(),
    )
    field = np.zeros(y.size, complex)
    np.add.at(field, paths.receiver, paths.gain)
    return field


free_m = np.hypot(receivers[:, 0] - plan.source[0], y - plan.source[1])
free_space = transmitter.wavelength_m / (4.0 * np.pi * free_m)
with np.errstate(divide="ignore"):
    ray_db, total_db = (20.0 * np.log10(np.abs(field_of(d)) / free_space) for d in (0, 1))

# %%
# The knife edge: :math:`J(\nu)`, with :math:`\nu` from the clearance between the wall's end and the
# line of sight.
before_m, behind_m = 25.0, 30.0
clearance_m = (y - plan.source[1]) * before_m / (before_m + behind_m)
nu = -clearance_m * np.sqrt(
    2.0 * (before_m + behind_m) / (transmitter.wavelength_m * before_m * behind_m)
)
sine, cosine = fresnel(nu)
knife_edge_db = 10.0 * np.log10(((0.5 - cosine) ** 2 + (0.5 - sine) ** 2) / 2.0)

near = np.abs(nu) < 2.0
print(f"maximum difference for |nu| < 2: {np.max(np.abs(total_db - knife_edge_db)[near]):.2f} dB")

# %%
figure, ax = plt.subplots(figsize=(COLUMN_IN, 2.6), layout="constrained")
ax.plot(y, ray_db, color="0.6", label="line of sight only")
ax.plot(y, total_db, label="with diffraction")
ax.plot(y, knife_edge_db, "k:", label="knife edge")
ax.axvline(20.0, color="0.85", zorder=0)
ax.set_xlabel("$y$ of the receiver [m]")
ax.set_ylabel("relative to free space [dB]")
ax.set_ylim(-32, 4)
ax.legend(loc="lower right")
plt.show()
