"""``rssnav doctor``: versions of the installation, and a self-test."""

import platform
import time
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
import typer

import floorplans
from raytrace import TraceConfig, Transmitter, received_power, trace_paths
from raytrace.compilation import watched_compilation
from raytrace.radio.itu import DEFAULT_EDITION
from raytrace.threads import n_threads
from raytrace.trace import TRACER_VERSION
from rssnav import GridWorld, LocationAgent, RssAgent, ToleranceStates, train
from rssnav.cli.console import print_json, print_pairs, stage_progress
from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.cli.options import Json, examples
from rssnav.first_use import BOX, compile_kernels
from rssnav.kernel_cache import CacheState, learning_cache, tracer_cache
from rssnav.maps import make_map
from rssnav.presets import PRESETS
from rssnav.scenes import scene_of

LIBRARIES = ("numpy", "numba", "scipy", "shapely", "trimesh", "h5py", "matplotlib", "typer")


def add_to(parent: typer.Typer) -> None:
    """Add the command ``doctor``."""
    parent.command("doctor", epilog=examples("rssnav doctor", "rssnav doctor --json"))(examine)


def examine(as_json: Json = False) -> None:
    """Print versions, threads and the state of the compiled kernels, and run a self-test."""
    with stage_progress(), watched_compilation() as compilation:
        compile_kernels("paper")
        _load_kernels()
        started_s = time.perf_counter()
        faults = [*_tracer_faults(), *_learning_faults()]
    caches = {"tracer": tracer_cache(), "learning": learning_cache()}
    times_s = {
        "self_test_s": time.perf_counter() - started_s,
        "compilation_s": compilation.seconds,
    }
    summary = _summary(caches, times_s, faults)
    if as_json:
        print_json(summary)
    else:
        _print(summary, caches)
    for fault in faults:
        print_error(fault)
    if faults:
        raise typer.Exit(EXIT_FAILURE)


def _load_kernels() -> None:
    """Call all kernels of ``map``, ``paths`` and ``train``, which compiles those not cached."""
    plan = floorplans.load("flat")
    config = TraceConfig(max_reflections=1, max_diffractions=1, max_transmissions=1)
    radio_map = make_map(plan, config=config)
    receiver = np.array([[*plan.require_start(), 1.0]])
    scene, building = scene_of(plan), PRESETS["building"]
    trace_paths(scene, radio_map.transmitter, receiver, config)
    sender = replace(radio_map.transmitter, antenna=building.antenna)
    config = replace(building.config, max_reflections=1)
    received_power(scene, sender, receiver, config, receive_antenna=building.antenna)
    world = GridWorld.from_map(plan, radio_map)
    for agent in (LocationAgent(), RssAgent(states=ToleranceStates(1.0), terminal_dbm=-30.0)):
        train(world, agent, runs=1, episodes=1)


def _tracer_faults() -> list[str]:
    """Trace a box: line of sight as in free space, and six first-order images."""
    plan = floorplans.loads(BOX)
    x, y, z = source = plan.require_source()
    receiver = np.array([[x + 4.0, y, z]])
    transmitter = Transmitter(source)
    paths = trace_paths(scene_of(plan), transmitter, receiver, TraceConfig(1, 0))
    faults: list[str] = []
    if len(paths) != 7:
        faults.append(f"tracer: {len(paths)} paths in a box, expected 1 + 6 images")
    free_space = transmitter.wavelength_m / (4.0 * np.pi * 4.0)
    error_db = float(20.0 * np.log10(np.abs(paths.gain[0]) / free_space))
    if abs(error_db) > 1e-3:
        faults.append(f"tracer: line of sight {error_db:+.3f} dB off free space")
    return faults


def _learning_faults() -> list[str]:
    """Train in a box: every flight reaches the source, for any number of threads alike."""
    plan = floorplans.loads(BOX)
    world = GridWorld.from_map(plan, make_map(plan, config=TraceConfig(1, 0)))
    one, two = (
        train(world, LocationAgent(), runs=2, episodes=200, threads=threads) for threads in (1, 2)
    )
    faults: list[str] = []
    if not one.reached.all():
        faults.append("learning: a trained agent does not reach the source in an empty box")
    if not np.array_equal(one.steps, two.steps):
        faults.append("learning: the result depends on the number of threads")
    return faults


def _summary(
    caches: dict[str, CacheState], times_s: dict[str, float], faults: list[str]
) -> dict[str, Any]:
    return {
        "rssnav": version("rssnav"),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "libraries": {name: version(name) for name in LIBRARIES},
        "tracer_version": TRACER_VERSION,
        "material_edition": DEFAULT_EDITION,
        "threads": n_threads(),
        "kernels": {
            name: {
                "folder": None if cache.folder is None else str(cache.folder),
                "compiled": cache.n_compiled,
                "bytes": cache.n_bytes,
            }
            for name, cache in caches.items()
        },
        **times_s,
        "faults": faults,
    }


def _print(summary: dict[str, Any], caches: dict[str, CacheState]) -> None:
    print_pairs(
        [
            ("rssnav", f"{summary['rssnav']} (tracer {summary['tracer_version']})"),
            ("python", f"{summary['python']} on {summary['platform']}"),
            *summary["libraries"].items(),
            ("materials", summary["material_edition"]),
            ("threads", summary["threads"]),
            *((f"{name} kernels", _state(cache)) for name, cache in caches.items()),
            ("compilation", _compilation(summary["compilation_s"])),
            ("self-test", f"{'failed' if summary['faults'] else 'passed'}, "
                          f"{summary['self_test_s']:.1f} s"),
        ]
    )  # fmt: skip


def _compilation(seconds: float) -> str:
    return f"{seconds:.0f} s, first use only" if seconds else "not needed, all kernels are cached"


def _state(cache: CacheState) -> str:
    if cache.folder is None:
        return "compiled at every start: no folder for them can be written"
    return f"{cache.n_compiled} compiled, {cache.n_bytes / 1e6:.1f} MB in {cache.folder}"
