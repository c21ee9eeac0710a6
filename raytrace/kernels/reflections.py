"""Paths that are only reflected: every hit of a beam, at every image height."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.kernels.beam_hits import Hits
from raytrace.kernels.beams import FRACTION, IMAGE_X, IMAGE_Y, ORDER, Tree
from raytrace.kernels.blocks import next_block
from raytrace.kernels.bounds import all_heights, free_space, image_bound, leg_bound
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import new_ray, propagate
from raytrace.kernels.field_tables import FieldTables, phasor
from raytrace.kernels.guard import is_stopped
from raytrace.kernels.lanes import all_false, any_of, lanes_of, load, minimum
from raytrace.kernels.records import record_paths
from raytrace.kernels.sums import empty_bundle, with_path
from raytrace.kernels.unfolding import Leg, unfold
from raytrace.kernels.validity import (
    ONE_SIDED_OFFSETS_M,
    next_evaluation,
    one_sided_weight,
    validity_weight,
    walls_met,
)
from raytrace.kernels.waves import launch, receive
from raytrace.kernels.workspace import (
    Collector,
    Workspace,
    add_bundle,
    add_left_out,
    apply_power_threshold,
    count_path,
    has_threshold,
    least_powers,
)


class ReflectionBeams(NamedTuple):
    """Beams from the transmitter, and the receivers visible from them."""

    tree: Tree
    hits: Hits


@jit(fast=True, allocates=False)
def sum_reflections(
    geometry: TraceGeometry,
    tables: FieldTables,
    beams: ReflectionBeams,
    leg: Leg,
    workspace: Workspace,
    collector: Collector,
) -> None:
    """Add the paths of all hits of the transmitter's beam tree.

    Parameters
    ----------
    geometry, tables
        The geometry of the trace, and the tables of its fields.
    beams
        Beams and receivers.
    leg, workspace
        Scratch.
    collector
        Added to.
    """
    (tree, hits), building, wavelength = beams, geometry.building, tables.wavelength
    z_transmitter = geometry.transmitter[2]
    z_root = lanes_of(z_transmitter)
    zero = first = int(np.int64(0))  # a literal would be compiled as a type of its own
    while first < len(hits.pair) and not is_stopped(collector.guard):
        block = next_block(geometry, hits, first, workspace)
        first += block.n
        is_bounded = has_threshold(collector)
        least = least_powers(collector, workspace)
        i = block.beam
        order = tree.link[i, ORDER]
        n, length, ux, uy = unfold(building.plan, tree.link, tree.beam, i, (block.x, block.y), leg)
        inv_length = 1.0 / length
        arriving = (
            (tree.beam[i, IMAGE_X] - block.x) * inv_length,
            (tree.beam[i, IMAGE_Y] - block.y) * inv_length,
        )
        n_images = 2 * (geometry.max_reflections - order) + 1
        weight_here, bound = block.weight, lanes_of(0.0)
        if is_bounded:
            kept = leg_bound(geometry, tables, leg, n, length, order)
            bound = free_space(tables, length) * minimum(kept, tree.beam[i, FRACTION])
            left = geometry.max_reflections - order
            several = float(n_images), all_heights(collector.heights, left, length, building.height)
            weight_here = apply_power_threshold(
                collector, workspace, least, bound, weight_here, several
            )
        bundle = empty_bundle(tables)
        k, side, grazing = zero, zero, all_false()
        while k < n_images:
            slope = (load(workspace.image_z[k]) - z_transmitter) * inv_length
            offset = ONE_SIDED_OFFSETS_M[side]
            n_transmissions, grazes = walls_met(building, leg, n, z_root, slope, offset)
            weight = weight_here * validity_weight(n_transmissions, geometry.max_transmissions)
            weight, grazing = one_sided_weight(side, weight, grazing, grazes, 0.5)
            if is_bounded:
                of_image = bound * image_bound(building, tables, slope, geometry.image_bounces[k])
                weight = apply_power_threshold(
                    collector, workspace, least, of_image, weight, (1.0, lanes_of(1.0))
                )
            if any_of(weight > 0.0):
                ray = new_ray(building, tables, slope, geometry.image_bounces[k])
                wave = launch(tables, (ux, uy), ray.sin_elevation)
                heights, seen = (z_root, offset), workspace.coefficients
                wave = propagate(building, tables, leg, n, length, ray, heights, seen, wave)
                distance = length * ray.sec_elevation
                phase = phasor(tables.cis, distance * (1.0 / wavelength))
                spreading = (wavelength / (4.0 * math.pi)) / distance
                gain = receive(tables, wave, arriving) * (phase * spreading)
                count_path(workspace, order + ray.bounces, weight)
                bundle = with_path(bundle, gain, distance - block.straight, weight, arriving)
                if collector.record.used[0] >= 0:
                    at = (block.first, block.n)
                    record_paths(collector.record, at, -1, (-1, k, side), gain, weight)
            k, side = next_evaluation(k, side, grazing)
        add_bundle(collector.sums, workspace, block.n, bundle)
        if is_bounded:
            add_left_out(collector.sums, workspace, block.n)
