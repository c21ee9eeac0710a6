"""Paths that are only reflected: every beam hit, at every image height."""

import math

from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, ORDER, Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import carried, new_ray, phasor, received, sent
from raytrace.kernels.lanes import any_of, lanes_of, load, none_chosen
from raytrace.kernels.tracing import (
    Record,
    Room,
    Sums,
    Trace,
    add_bundle,
    counted,
    free_space,
    leg_bound,
    next_block,
    no_paths,
    recorded,
    strong,
    with_path,
)
from raytrace.kernels.unfolding import LOOKS, fitting, next_look, share_of_look, unfold, walls_met


@jit(fast=True, allocates=False)
def sum_reflections(
    trace: Trace, tree: Tree, hits: Hits, room: Room, sums: Sums, record: Record
) -> None:
    """Add the paths of all hits of the source's beam tree.

    Parameters
    ----------
    trace, tree
        The trace and the beams from the source.
    hits
        Receivers and beams.
    room
        To work in.
    sums, record
        Added to.
    """
    height, z_source, wavelength = trace.radio.height, trace.source[2], trace.radio.wavelength
    z_root, leg = lanes_of(z_source), room.leg
    first = 0
    while first < len(hits.pair):
        block = next_block(trace, hits, first, room)
        first += block.n
        i = block.beam
        order = tree.link[i, ORDER]
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, (block.x, block.y), leg)
        per_length = 1.0 / length
        arriving = (
            (tree.beam[i, IMAGE_X] - block.x) * per_length,
            (tree.beam[i, IMAGE_Y] - block.y) * per_length,
        )
        n_images = 2 * (trace.max_order - order) + 1
        share_here = block.share
        if trace.least_power > 0.0:
            bound = free_space(trace, length) * leg_bound(trace, leg, n, length, order)
            share_here = strong(trace, sums, room, bound, share_here, float(n_images))
        bundle = no_paths()
        k, look, touching = 0, 0, none_chosen()
        while k < n_images:
            slope, nudge = (load(room.image_z[k]) - z_source) * per_length, LOOKS[look]
            through, at_rims = walls_met(trace.plan, leg, n, z_root, slope, height, nudge)
            share = share_here * fitting(through, trace.max_walls)
            share, touching = share_of_look(look, share, touching, at_rims, 0.5)
            if any_of(share > 0.0):
                ray, heights = new_ray(trace.radio, slope, trace.image_bounces[k]), (z_root, nudge)
                wave = sent(trace.radio, (ux, uy), ray)
                wave = carried(trace.plan, trace.radio, leg, n, length, ray, heights, wave)
                distance = length * ray.stretch
                turned = phasor(trace.radio.cis, distance * (1.0 / wavelength))
                size = (wavelength / (4.0 * math.pi)) / distance
                gain = received(trace.radio, wave, arriving) * (turned * size)
                counted(room, order + ray.bounces, share)
                bundle = with_path(bundle, gain, distance - block.straight, share, arriving)
                if record.used[0] >= 0:
                    hit = (block.first, block.n)
                    recorded(record, hit, -1, (-1, k, look), gain, share)
            k, look = next_look(k, look, touching)
        add_bundle(sums, block, bundle, room)
