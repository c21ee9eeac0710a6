"""The field of paths that cross a horizontal edge."""

import math

from raytrace.arrays import Floats
from raytrace.kernels.beams import IMAGE_X, IMAGE_Y
from raytrace.kernels.building import Building, TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_rays import from_frame
from raytrace.kernels.field import Ray, new_ray, propagate
from raytrace.kernels.field_tables import FieldTables, phasor
from raytrace.kernels.horizontal_edge_legs import (
    EdgeLegs,
    EdgePath,
    EdgeWorkspace,
    HorizontalEdgeArrays,
)
from raytrace.kernels.lanes import ComplexLanes, Lanes, MatrixLanes, lanes_of, sqrt
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.unfolding import Leg
from raytrace.kernels.utd import common_factor, diffracted, wedge_terms
from raytrace.kernels.validity import validity_weight
from raytrace.kernels.waves import Component, Wave, launch, receive
from raytrace.kernels.wedge import FaceAngles, face_angles


@jit(inline=True)
def hypot(a: Lanes, b: Lanes) -> Lanes:
    """Lengths of vectors with two components."""
    return sqrt(a * a + b * b)


@jit(fast=True, inner=True)
def propagate_not_inlined(
    building: Building,
    tables: FieldTables,
    leg: Leg,
    n: int,
    length: Lanes,
    ray: Ray,
    heights: tuple[Lanes, float],
    seen: Floats,
    wave: Wave,
) -> Wave:
    """`field.propagate`, not inlined."""
    return propagate(building, tables, leg, n, length, ray, heights, seen, wave)


@jit(fast=True, inner=True)
def edge_gain(
    geometry: TraceGeometry,
    tables: FieldTables,
    path: EdgePath,
    legs: EdgeLegs,
    images: Floats,
    offsets: tuple[float, float],
    n_transmissions: Lanes,
    work: EdgeWorkspace,
) -> ComplexLanes | MatrixLanes:
    """Gains of paths.

    Parameters
    ----------
    geometry, tables, path, legs
        The geometry of the trace, the tables of its fields, the paths and their legs.
    images
        (n, >= 2) of the transmitter in its beams [m].
    offsets, n_transmissions
        Height offsets before and behind the edge [m], and the paths' numbers of transmissions.
    work
        What they meet.
    """
    building, edge, frame = geometry.building, path.edge, path.edge.frame
    ray_in = new_ray(building, tables, legs.slope_in, path.bounces_in)
    ray_out = new_ray(building, tables, legs.slope_out, path.bounces_out)
    heights, seen = (lanes_of(geometry.transmitter[2]), offsets[0]), work.workspace.coefficients
    wave = launch(tables, legs.departure, ray_in.sin_elevation)
    wave = propagate_not_inlined(
        building, tables, work.leg_in, legs.n_in, legs.length_in, ray_in, heights, seen, wave
    )
    # direction of arrival at the edge, from the image of the transmitter in the last beam
    x, y = from_frame(frame, path.u)
    vx = (x - images[path.beam_in, IMAGE_X]) / legs.length_in
    vy = (y - images[path.beam_in, IMAGE_Y]) / legs.length_in
    rise_in, inv_before = edge.z - path.z_in, 1.0 / path.before
    sin_beta = math.hypot(rise_in, path.h_in) * inv_before
    ux, uy = legs.leaving
    cos_beta = ray_out.cos_elevation * (ux * frame[0] + uy * frame[1]) * -edge.up
    # into the edge's polarisations, along it and across, and out again: two rotations
    along, across = turned_to_edge(frame, vx, vy, rise_in * inv_before)
    inv_sin2 = 1.0 / (sin_beta * sin_beta)
    at_edge = (
        (wave.v * along + wave.h * across) * inv_sin2,
        (wave.h * along - wave.v * across) * inv_sin2,
    )
    transmits = validity_weight(n_transmissions, geometry.max_transmissions - 1)
    parallel, normal = over_edge(tables, path, (sin_beta, cos_beta), at_edge, transmits, work)
    along, across = turned_to_edge(frame, ux, uy, ray_out.sin_elevation)
    v, h = parallel * along - normal * across, parallel * across + normal * along
    wave, heights = Wave(v, h, ray_out.sin_elevation, lanes_of(0.0)), (lanes_of(edge.z), offsets[1])
    wave = propagate_not_inlined(
        building, tables, work.leg_out, legs.n_out, legs.length_out, ray_out, heights, seen, wave
    )
    total = path.before + path.after
    product = path.before * path.after
    spreading = (tables.wavelength / (4.0 * math.pi)) / (sqrt(product * total) * sin_beta)
    phase = phasor(tables.cis, total * (1.0 / tables.wavelength))
    gain = receive(tables, wave, legs.arriving) * (phase * spreading)
    return gain * common_factor(2.0, tables.wavelength)


@jit(inline=True, fast=True)
def turned_to_edge(frame: Floats, ux: Lanes, uy: Lanes, sin_el: Lanes) -> tuple[Lanes, Lanes]:
    """Components of tau and psi along a horizontal edge (docs/theory.md, eqs. 23-24)."""
    tx, ty = frame[0], frame[1]
    return -sin_el * (ux * tx + uy * ty), ux * ty - uy * tx


@jit(inline=True, fast=True)
def angles_at_edge(path: EdgePath, rows: Floats) -> tuple[FaceAngles, FaceAngles]:
    """Angles from the wall behind the edge and before it, on the receivers' side.

    The transmitter may stand on either side; `rows` is scratch.
    """
    incident = angles_from_wall(path.edge, lanes_of(path.h_in), lanes_of(path.z_in), rows)
    return angles_from_wall(path.edge, path.h_out, path.z_out, rows), incident


@jit(inline=True, fast=True)
def angles_from_wall(edge: HorizontalEdgeArrays, h: Lanes, z: Lanes, rows: Floats) -> FaceAngles:
    """Angles of points, off the edge in the plan view and high [m]; `rows` is scratch."""
    rise = (z - edge.z) * edge.up
    inverse = 1.0 / hypot(h, rise)
    return face_angles(edge.wedge, rise * inverse, h * inverse, rows)


@jit(fast=True, inner=True)
def over_edge(
    tables: FieldTables,
    path: EdgePath,
    beta: tuple[Lanes, Lanes],
    field: tuple[Component, Component],
    transmits: Lanes,
    work: EdgeWorkspace,
) -> tuple[Component, Component]:
    """Fields behind the half plane, without its common factor (see `utd.diffracted`)."""
    edge = path.edge
    at, incident = angles_at_edge(path, work.workspace.rows)
    inv_in = 1.0 / math.hypot(path.h_in, path.z_in - edge.z)
    inv_out = 1.0 / hypot(path.h_out, path.z_out - edge.z)
    grazing = (abs(path.h_in) + path.h_out) * inv_out * (0.5 * GRAZING_M * inv_in)
    terms = wedge_terms(edge.wedge, at, incident, grazing)
    product = path.before * path.after / (path.before + path.after)
    sqrt_2kl = sqrt((4.0 * math.pi / tables.wavelength) * product) * beta[0]
    return diffracted(tables, edge.wedge, terms, sqrt_2kl, beta, field, transmits)
