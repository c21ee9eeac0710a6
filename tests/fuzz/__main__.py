"""``python -m fuzz``: attack every reader, option and boundary for a time."""

from __future__ import annotations

import argparse
import hashlib
import sys
from pathlib import Path

from fuzz.supervisor import Outcome, Worker, fuzz, minimised, preparation, replay
from fuzz.targets import TARGETS
from raytrace.threads import n_threads


def main() -> int:
    """Run, print failures and counts; return 1 if there is a failure."""
    arguments = _arguments()
    with preparation():
        if arguments.replay:
            return _replay(arguments.target[0], arguments.replay)
        return _fuzz(arguments)


def _fuzz(arguments: argparse.Namespace) -> int:
    names = arguments.target or list(TARGETS)
    outcome = fuzz(names, arguments.seconds, arguments.seed, arguments.workers)
    _report(outcome, arguments.keep, arguments.seed)
    for name in names:
        print(f"  {name:<10} {outcome.inputs[name]:>8} inputs")
    print(outcome.summary())
    return int(bool(outcome.examples))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long to run")
    parser.add_argument("--seed", type=int, default=0, help="same seed, same inputs")
    parser.add_argument("--workers", type=int, default=n_threads(), help="processes")
    parser.add_argument(
        "--target", action="append", choices=sorted(TARGETS), help="only this; may be repeated"
    )
    parser.add_argument(
        "--keep", type=Path, default=Path("fuzz-failures"), help="folder of inputs that fail"
    )
    parser.add_argument("--replay", type=Path, help="run this input of the one --target")
    return parser.parse_args()


def _report(outcome: Outcome, folder: Path, seed: int) -> None:
    """Save the smallest input of each failure that can be found, and print the failure."""
    with Worker(seed) as worker:
        for signature, failure in sorted(outcome.examples.items()):
            small = minimised(failure, worker)
            name = hashlib.sha256(signature.encode()).hexdigest()[:8]
            path = folder / f"{small.target}-{name}{TARGETS[small.target].suffix}"
            folder.mkdir(parents=True, exist_ok=True)
            path.write_bytes(small.case)
            path.with_name(path.name + ".why").write_text(small.detail)
            print(f"{signature}: {path} ({len(small.case)} bytes)", flush=True)


def _replay(target: str, path: Path) -> int:
    with Worker(0) as worker:
        failure = replay(target, path.read_bytes(), worker)
    print(failure.detail if failure else "no failure")
    return int(failure is not None)


if __name__ == "__main__":
    sys.exit(main())
