"""Paths that are only reflected: every hit of a beam, at every image height."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beam_hits import Hits
from raytrace.kernels.beams import FRACTION, IMAGE_X, IMAGE_Y, ORDER, Tree
from raytrace.kernels.blocks import next_block
from raytrace.kernels.bounds import all_heights, free_space, image_bound, leg_bound
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import new_ray, propagate
from raytrace.kernels.field_tables import (
    FieldTables,
    FrequencyTables,
    for_others,
    phasor,
    tables_at,
)
from raytrace.kernels.guard import is_stopped
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    MatrixLanes,
    all_false,
    any_of,
    lanes_of,
    load,
    minimum,
)
from raytrace.kernels.records import record_paths
from raytrace.kernels.sums import empty_bundle, loaded_bundle, store_bundle, with_path
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


class Legs(NamedTuple):
    """Eight legs from the transmitter to receivers, of one beam.

    Attributes
    ----------
    leg, n, length
        The legs, their interactions, and horizontal lengths [m].
    departure, arriving
        Horizontal directions in which they leave, and from which they come.
    straight
        Distances from the transmitter to the receivers [m].
    """

    leg: Leg
    n: int
    length: Lanes
    departure: tuple[Lanes, Lanes]
    arriving: tuple[Lanes, Lanes]
    straight: Lanes


@jit(inline=True, fast=True)
def gain_along(
    geometry: TraceGeometry,
    tables: FieldTables,
    legs: Legs,
    image: tuple[Lanes, int, float],
    seen: Floats,
) -> tuple[ComplexLanes | MatrixLanes, Lanes]:
    """Gains of paths, and their lengths [m].

    `image` holds slopes, reflections at floor and ceiling, and the offset of heights; for `seen`
    see `field.propagate`.
    """
    (slope, bounces, offset), building = image, geometry.building
    heights = lanes_of(geometry.transmitter[2]), offset
    ray = new_ray(building, tables, slope, bounces)
    wave = launch(tables, legs.departure, ray.sin_elevation)
    wave = propagate(building, tables, legs.leg, legs.n, legs.length, ray, heights, seen, wave)
    distance = legs.length * ray.sec_elevation
    phase = phasor(tables.cis, distance * (1.0 / tables.wavelength))
    spreading = (tables.wavelength / (4.0 * math.pi)) / distance
    return receive(tables, wave, legs.arriving) * (phase * spreading), distance


OtherPaths = tuple[TraceGeometry, Legs, tuple[Lanes, int, float], Lanes, Workspace]
"""Geometry; legs; slopes, reflections at floor and ceiling, and the offset of heights; weights;
what is added to."""


@for_others
@jit(inline=True, fast=True)
def add_to_others(every: FrequencyTables, paths: OtherPaths) -> None:
    """Add paths with each of the other tables to `Workspace.bundles`."""
    geometry, legs, image, weight, workspace = paths
    for f in range(len(workspace.bundles)):
        tables, rows = tables_at(every, f), workspace.bundles[f]
        gain, distance = gain_along(geometry, tables, legs, image, workspace.coefficients)
        bundle = loaded_bundle(tables, rows)
        bundle = with_path(bundle, gain, distance - legs.straight, weight, legs.arriving)
        store_bundle(rows, bundle)


@jit(fast=True, allocates=False)
def sum_reflections(
    geometry: TraceGeometry,
    every: FrequencyTables,
    beams: ReflectionBeams,
    leg: Leg,
    workspace: Workspace,
    collector: Collector,
) -> None:
    """Add the paths of all hits of the transmitter's beam tree.

    Parameters
    ----------
    geometry, every
        The geometry of the trace, and the tables of its fields.
    beams
        Beams and receivers.
    leg, workspace
        Scratch.
    collector
        Added to.
    """
    (tree, hits), building, tables = beams, geometry.building, every.first
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
                legs = Legs(leg, n, length, (ux, uy), arriving, block.straight)
                image = slope, geometry.image_bounces[k], offset
                gain, distance = gain_along(geometry, tables, legs, image, workspace.coefficients)
                count_path(workspace, order + geometry.image_bounces[k], weight)
                bundle = with_path(bundle, gain, distance - block.straight, weight, arriving)
                add_to_others(every, (geometry, legs, image, weight, workspace))
                if collector.record.used[0] >= 0:
                    at = (block.first, block.n)
                    record_paths(collector.record, at, -1, (-1, k, side), gain, weight)
            k, side = next_evaluation(k, side, grazing)
        add_bundle(collector, workspace, block.n, bundle)
        if is_bounded:
            add_left_out(collector.sums, workspace, block.n)
