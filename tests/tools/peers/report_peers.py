"""Writes results/peers/, and the row of README.md on speed: nearflat and its peers on the same work, in one run.

    pip install "nearflat[peers]"      # a peer that is not there is left out, and so is the loop in C++; not
                                       # heyoka, whose extended precision is the truth
    OMP_NUM_THREADS=1 taskset -c 0 python -m tools.peers.report_peers      # in tests/; some minutes

Rates are trajectories per second of the processor's time; compiling is not in them. Compare within one run only.
"""

import argparse
import os
import shlex
import sys
from pathlib import Path

import numpy as np
from processor import processor
from tools.peers import ours, tables
from tools.peers.figure import draw
from tools.peers.measuring import ROUNDS, all_solvers, measured
from tools.peers.problem import COUNT

from explorer.pictures.register import save

ROOT = Path(__file__).parents[3]
OUT = ROOT / "results" / "peers"


def command():
    """How this run was asked for, with what it was told about the processor."""
    told = [
        f"{name}={os.environ[name]}" for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES") if name in os.environ
    ]
    return " ".join([*told, "python -m tools.peers.report_peers", *map(shlex.quote, sys.argv[1:])])


def machine():
    """The processor, and what our kernels are compiled for."""
    target = os.environ.get("NUMBA_CPU_NAME")
    compiled = (
        f"; our kernels and the loop in C++ are compiled for {target}, heyoka for the machine" if target else ""
    )
    return f"one core of an {processor()}{compiled}"


def page(rows, missing, busy):
    """The page of the results."""
    return [
        "# nearflat and its peers",
        "",
        f"Made by `{command()}` in `tests/`, all rows in one run on {machine()}. The load of the machine was",
        f"{busy[0]:.1f} before and {busy[1]:.1f} after. The solvers take turns in {ROUNDS} rounds. A solver's",
        "time is the processor time of its quickest call. The task is in `tests/tools/peers/problem.py`: chi, the",
        "direction in which the contact point lies, at t = 1.6, just after the first passage, for 256",
        "trajectories with |eta_hat|, the distance from the falling set, from 1e-6 to 1e-1. Machines differ, so",
        "only the ratios count.",
        "",
        *(f"Not in this run: {sentence}" for sentence in missing),
        "## What a user calls",
        "",
        "The calls are `explorer.passages(disk, 1.0, eta_hat, 1.0, method=..., accuracy=...)` and",
        '`explorer.simulate(states, t_eval=[1.6], observables=("chi",), accuracy=...)`. A call has',
        f"{COUNT * ours.COPIES:,} trajectories: the {COUNT}, repeated {ours.COPIES} times.",
        "`passages` gives the whole passage, vertical to vertical, with its race, fall, tilt, times and error",
        "estimates. Peers give only chi at t = 1.6. They solve either the plain equations, as a user would write",
        "them, or our regularised ones, which stay smooth at flat. The variable of the regularised equations is s",
        "instead of t; peers that solve these are told the s that belongs to t = 1.6.",
        "Ratios compare the fastest settings that meet the",
        "accuracy: the 99th percentile is within it, every trajectory is resolved, and none goes the wrong way. A",
        "dash means that there is no such setting. Quadrature at 1e-11 is compared with the peer's most accurate",
        "row; in the second table also with the peer at 1e-9.",
        "",
        *tables.public_calls(rows),
        "",
        "Each entry is the speed of our call divided by the speed of the peer.",
        "*Integrated*: the fastest integrator of `passages` (rk4, rk8, dopri5 or dop853) at that accuracy.",
        "",
        *tables.ratios(rows),
        "",
        "![error and rate of all solvers](peers.png)",
        "",
        tables.loop_in_words(),
        "",
        "## All rows",
        "",
        "*Wrong way*: how often the contact point races in the wrong direction. The setting is the accuracy",
        "asked, the tolerance, or the step.",
        "",
        *tables.every(rows),
    ]


def read_arguments():
    """Where the page goes, and which peers are in the run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=OUT, help="folder of a page alone, without README.md's row")
    parser.add_argument("--peers", default="", metavar="NAME", help="only peers whose name begins so")
    return parser.parse_args()


def main():
    asked = read_arguments()
    asked.out.mkdir(parents=True, exist_ok=True)
    before = os.getloadavg()[0] if hasattr(os, "getloadavg") else np.nan
    found, missing = all_solvers(asked.peers)
    rows = measured(found, say=lambda line: print(line, flush=True))
    after = os.getloadavg()[0] if hasattr(os, "getloadavg") else np.nan
    lines = page(rows, missing, (before, after))
    if asked.out != OUT:
        lines = [line for line in lines if not line.startswith("![")]
    (asked.out / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if asked.out != OUT or asked.peers:
        return
    save(draw(rows), OUT / "peers.png")
    front = ROOT / "README.md"
    front.write_text(tables.with_quoted(front.read_text("utf-8"), rows, machine()), encoding="utf-8")


if __name__ == "__main__":
    main()
