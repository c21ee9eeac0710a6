"""Paths that are only reflected: every beam hit, at every image height."""

import math

from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, ORDER, Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import arriving_sine, carried, new_ray, phasor, received, sent
from raytrace.kernels.tracing import (
    Record,
    Sums,
    Trace,
    arrived,
    free_space,
    leave_out,
    leg_bound,
    recorded,
    straight_line,
)
from raytrace.kernels.unfolding import Leg, fitting, unfold


@jit(fast=True, allocates=False)
def sum_reflections(
    trace: Trace, tree: Tree, hits: Hits, leg: Leg, sums: Sums, record: Record
) -> None:
    """Add the paths of all hits of the source's beam tree.

    Parameters
    ----------
    trace, tree
        The trace and the beams from the source.
    hits
        Receivers and beams.
    leg
        Room for the longest leg.
    sums, record
        Added to.
    """
    z_source, height = trace.source[2], trace.radio.height
    for hit in range(len(hits.pair)):
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        x, y = trace.receivers[r, 0], trace.receivers[r, 1]
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, (x, y), leg)
        arriving = (tree.beam[i, IMAGE_X] - x) / length, (tree.beam[i, IMAGE_Y] - y) / length
        order, straight = tree.link[i, ORDER], straight_line(trace, r)
        if trace.least_power > 0.0:
            bound = free_space(trace, length) * leg_bound(trace, leg, n, length, order)
            if bound < trace.least_power:
                left = 2 * (trace.max_order - order) + 1
                leave_out(trace, sums, r, bound, left * hits.share[hit])
                continue
        for k in range(2 * (trace.max_order - order) + 1):
            rise = trace.image_z[trace.level[r], k] - z_source
            slope = rise / length
            share = fitting(trace.plan, leg, n, z_source, slope, height, trace.max_walls)
            share *= hits.share[hit]
            if share == 0.0:
                continue
            bounces = trace.image_bounces[k]
            ray = new_ray(trace.radio, slope, bounces)
            upright, level = sent(trace.radio, (ux, uy), ray.sin_el)
            upright, level, done = carried(
                trace.plan, trace.radio, leg, n, length, ray, z_source, (upright, level, 0)
            )
            gain = received(trace.radio, (upright, level), arriving, arriving_sine(ray, done))
            distance = math.sqrt(length * length + rise * rise)
            size = trace.radio.wavelength / (4.0 * math.pi * distance)
            gain *= size * phasor(trace.radio.cis, distance / trace.radio.wavelength)
            arrived(sums, r, order + bounces, (gain, distance - straight, share), arriving)
            recorded(record, hit, -1, (-1, k), gain, share)
