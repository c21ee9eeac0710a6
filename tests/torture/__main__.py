"""``python -m torture``: kill, starve and double every command that writes."""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from own_interrupts import accept_interrupts

from raytrace.threads import n_threads
from torture import caches
from torture.attacks import Attacked, fill_the_disk, kill_at_random, write_twice
from torture.jobs import FAST, JOBS, Workshop

Attack = Callable[[str, Workshop, random.Random], Attacked]
ATTACKS: dict[str, Attack] = {
    "kills": kill_at_random, "full disks": fill_the_disk, "two writers": write_twice,
}  # fmt: skip


def main() -> int:
    """Run the attacks, print faults and counts; return 1 if there is a fault."""
    accept_interrupts()
    arguments = _arguments()
    names = arguments.job or list(FAST if arguments.fast else JOBS)
    counts, kills = dict.fromkeys((*ATTACKS, "caches"), 0), dict.fromkeys(names, 0)
    slowest_s, n_faults = 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)  # a stranger must come as far as the cache
        workshop = Workshop(Path(folder))
        for kind, attacked in _attacks(names, workshop, arguments):
            counts[kind] += attacked.n_attacks
            if kind == "kills":
                kills[attacked.name] += attacked.n_attacks
            slowest_s = max(slowest_s, attacked.slowest_s)
            n_faults += len(attacked.faults)
            for fault in attacked.faults:
                print(f"{kind}, {attacked.name}: {fault}", flush=True)
    n_faults += _never_killed(kills, arguments.kills)
    by_command = ", ".join(f"{count} {name}" for name, count in kills.items())
    counted = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    counted = counted.replace(" kills", f" kills ({by_command})", 1)
    print(f"{counted}: {n_faults} faults; slowest end {slowest_s:.1f} s after its signal")
    return int(n_faults > 0)


def _never_killed(kills: dict[str, int], wanted: int) -> int:
    """Print which commands were never killed though there were kills for all; return how many."""
    never = [name for name, count in kills.items() if not count]
    if not never or wanted < sum(JOBS[name].kills for name in kills):
        return 0
    print(f"kills: never {', '.join(never)}")
    return len(never)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="torture", description=__doc__)
    parser.add_argument("--kills", type=int, default=200, help="how many, about")
    parser.add_argument("--seed", type=int, default=0, help="of the moments and signals")
    parser.add_argument("--workers", type=int, default=n_threads(), help="jobs at once")
    parser.add_argument("--fast", action="store_true", help="only jobs that take seconds")
    parser.add_argument("--job", action="append", choices=sorted(JOBS), help="only this")
    parser.add_argument("--no-caches", action="store_true", help="leave the kernels' cache alone")
    return parser.parse_args()


def _attacks(
    names: list[str], workshop: Workshop, arguments: argparse.Namespace
) -> Iterator[tuple[str, Attacked]]:
    """Yield what came of each attack, and its kind."""
    for name in names:  # one after the other, so that each is run once
        workshop.after(name)
    plan = [("kills", name) for name in _enough(names, arguments.kills)]
    plan += [(kind, name) for name in names for kind in ("full disks", "two writers")]

    def run(number: int) -> tuple[str, Attacked]:
        kind, name = plan[number]
        generator = random.Random(f"{arguments.seed} {number}")
        return kind, ATTACKS[kind](name, workshop, generator)

    with ThreadPoolExecutor(arguments.workers) as pool:
        yield from pool.map(run, range(len(plan)))
    if not arguments.no_caches:
        yield from (("caches", attacked) for attacked in caches.attacks(workshop))


def _enough(names: list[str], n_kills: int) -> Iterator[str]:
    """Names in turn until the kills are enough; slow jobs come once only."""
    turn, given = 0, 0
    while given < n_kills:
        for name in names:
            if (turn == 0 or name in FAST or len(names) == 1) and given < n_kills:
                given += JOBS[name].kills
                yield name
        turn += 1


if __name__ == "__main__":
    sys.exit(main())
