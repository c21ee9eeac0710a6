"""Paths that are only reflected: every beam hit, at every image height."""

import math

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import ORDER, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import antenna_gain, carried, new_ray, phasor
from raytrace.kernels.tracing import Record, Sums, Trace, recorded
from raytrace.kernels.unfolding import Leg, heights_fit, unfold


@jit(fast=True, allocates=False)
def sum_reflections(
    trace: Trace, tree: Tree, hits: NDArray[np.int32], leg: Leg, sums: Sums, record: Record
) -> None:
    """Add the paths of all hits of the source's beam tree.

    Parameters
    ----------
    trace, tree
        The trace and the beams from the source.
    hits
        (n, 2) receiver and beam.
    leg
        Room for the longest leg.
    sums, record
        Added to.
    """
    z_source = trace.source[2]
    for hit in range(len(hits)):
        r, i = hits[hit, 0], hits[hit, 1]
        target = (trace.receivers[r, 0], trace.receivers[r, 1])
        n, length, _, _ = unfold(trace.plan, tree.link, tree.beam, i, target, leg)
        order = tree.link[i, ORDER]
        for k in range(2 * (trace.max_order - order) + 1):
            rise = trace.image_z[trace.level[r], k] - z_source
            slope = rise / length
            if not heights_fit(trace.plan, leg, n, z_source, slope, trace.radio.height):
                continue
            bounces = trace.image_bounces[k]
            ray = new_ray(trace.radio, slope, bounces)
            upright, _, done = carried(
                trace.plan, trace.radio, leg, n, length, ray, z_source, (1.0 + 0j, 0j, 0)
            )
            distance = math.sqrt(length * length + rise * rise)
            size = trace.radio.wavelength / (4.0 * math.pi * distance)
            size *= antenna_gain(trace.radio, ray, done)
            gain = upright * size * phasor(trace.radio.cis, distance / trace.radio.wavelength)
            sums.field[r] += gain
            sums.power[r] += gain.real * gain.real + gain.imag * gain.imag
            sums.n_paths[r, order + bounces] += 1
            recorded(record, hit, -1, (-1, k), gain)
