"""``python -m torture.clusters``: kill command, workers and scheduler of a data set, at random.

After each series of kills the command runs once more, alone; the data set must have the same bits
as one that was left alone.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from small_datasets import bits, edited

KILLS_A_SERIES = 5
TEXT = edited("seeds = 3", "seeds = 40")
CLUSTER = """
import sys
from pathlib import Path
from distributed import LocalCluster
if __name__ == "__main__":
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    new = Path(sys.argv[1] + ".new")
    new.write_text(cluster.scheduler_address)
    new.rename(sys.argv[1])
    sys.stdin.read()
"""


class Cluster:
    """A scheduler, which is the parent of two workers, in a session of its own."""

    def __init__(self, folder: Path) -> None:
        script, address = folder / "cluster.py", folder / "address"
        script.write_text(CLUSTER)
        address.unlink(missing_ok=True)
        self.process = subprocess.Popen(
            [sys.executable, str(script), str(address)], stdin=subprocess.PIPE,
            stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        while not address.exists():
            time.sleep(0.05)
        self.address = address.read_text()

    def workers(self) -> list[int]:
        """Process ids of the workers."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        pids = [int(word) for word in children.read_text().split()]
        return [p for p in pids if b"spawn_main" in Path(f"/proc/{p}/cmdline").read_bytes()]

    def end(self) -> None:
        """Kill the scheduler and its workers."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.communicate()


def command(spec: Path, folder: Path, *options: str) -> subprocess.Popen[bytes]:
    """Start to make the data set."""
    words = [sys.executable, "-m", "rssnav", "dataset", "make", str(spec), "-o", str(folder)]
    return subprocess.Popen(
        [*words, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def kill_one(spec: Path, folder: Path, generator: random.Random) -> str:
    """Make the data set on a new cluster, and kill one of all processes; return which."""
    cluster = Cluster(spec.parent)
    making = command(spec, folder, "--scheduler", cluster.address)
    try:
        time.sleep(4.0 + 8.0 * generator.random())
        victim = generator.choice(("command", "worker", "scheduler"))
        pids = {
            "command": [making.pid], "scheduler": [cluster.process.pid],
            "worker": cluster.workers(),
        }[victim]  # fmt: skip
        if making.poll() is None and pids:
            os.kill(generator.choice(pids), signal.SIGKILL)
        if victim == "worker":  # the command goes on with the other one and a new one
            making.wait(300)
        else:
            making.wait(120)
        return victim
    finally:
        making.kill()
        making.wait()
        cluster.end()


def main() -> int:
    """Run series of kills; return 1 if a data set differs."""
    parser = argparse.ArgumentParser(prog="torture.clusters", description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    generator = random.Random(arguments.seed)
    n_faults, killed = 0, dict.fromkeys(("command", "worker", "scheduler"), 0)
    with tempfile.TemporaryDirectory() as base:
        spec = Path(base) / "spec.toml"
        spec.write_text(TEXT)
        assert command(spec, Path(base) / "alone").wait() == 0
        wanted = bits(Path(base) / "alone")
        for series in range(-(-arguments.kills // KILLS_A_SERIES)):
            folder = Path(base) / f"set{series}"
            for _ in range(KILLS_A_SERIES):
                killed[kill_one(spec, folder, generator)] += 1
            code = command(spec, folder, "--threads", "2").wait()
            if code != 0 or bits(folder) != wanted:
                n_faults += 1
                other = set(bits(folder).items()) ^ set(wanted.items())
                names = sorted({name for name, _ in other})
                print(f"series {series}: exit code {code}, different: {names}", flush=True)
    counted = ", ".join(f"{count} {name}" for name, count in killed.items())
    print(f"{sum(killed.values())} kills ({counted}): {n_faults} faults")
    return int(n_faults > 0)


if __name__ == "__main__":
    sys.exit(main())
