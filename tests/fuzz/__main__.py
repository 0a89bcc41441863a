"""Tries many cases and writes the counts to results/faults/fuzz.json.

python -m tests.fuzz --cases 20000            # of the Python functions; a tenth of that of each other kind
python -m tests.fuzz --only api --seed 7
python -m tests.fuzz --only api --seed 8 --add     # to the counts that are stored
"""

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from explorer.compiled import warmup

from . import api, commands, folders, kernels
from .judge import FAULTS

OUT = Path(__file__).parents[2] / "results" / "faults" / "fuzz.json"
SHARES = {"api": 1.0, "commands": 0.05, "folders": 0.05, "states": 0.05, "kernels": 0.5}


def cases_of(kind, cases, seed, place):
    """The cases of one kind, as they are tried."""
    place.mkdir()
    return {
        "api": lambda: api.run(cases, seed),
        "commands": lambda: commands.run(cases, seed, place),
        "folders": lambda: folders.run(cases, seed, place),
        "states": lambda: folders.run_states(cases, seed, place),
        "kernels": lambda: kernels.run(cases, seed),
    }[kind]()


def try_all(kind, cases, seed, place):
    """Counts of what became of the cases of one kind, and the first of each fault; progress on stderr."""
    counts, examples, slowest, start = Counter(), {}, 0.0, time.monotonic()
    for number, (name, given, verdict) in enumerate(cases_of(kind, cases, seed, place)):
        counts[verdict.kind] += 1
        slowest = max(slowest, verdict.seconds)
        if verdict.kind in FAULTS:
            key = f"{verdict.kind}: {name[:80]}: {verdict.text[:160]}"
            if key not in examples:
                examples[key] = repr(given)[:300] if not isinstance(given, dict) else list(given)
                print(f"{key}\n    {_shown(given)}", file=sys.stderr, flush=True)
        if (number + 1) % 1000 == 0:
            print(f"{kind}: {number + 1} cases, {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    done = {"cases": sum(counts.values()), "values": counts["value"], "refused": counts["refused"]}
    done |= {fault: counts[fault] for fault in FAULTS}
    return done | {"slowest_seconds": round(slowest, 2), "seeds": [seed]}


def together(one, other):
    """The counts of two runs with different seeds."""
    if set(one["seeds"]) & set(other["seeds"]):
        raise SystemExit(f"--seed: {other['seeds']} was counted already; give another one")
    slowest = max(one["slowest_seconds"], other["slowest_seconds"])
    return {name: one[name] + other[name] for name in one} | {"slowest_seconds": slowest}


def _shown(given):
    try:
        return repr(given)[:400]
    except Exception:
        return "arguments that cannot be shown"


def main():
    """Compile first, since a compilation looks like a hang; then try, and store the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=SHARES, action="append")
    parser.add_argument("--add", action="store_true", help="to the counts of other seeds that are stored")
    given = parser.parse_args()
    warmup(say=lambda text: print(text, file=sys.stderr))
    report = json.loads(OUT.read_text()) if OUT.exists() and (given.only or given.add) else {}
    with tempfile.TemporaryDirectory() as place:
        for kind in given.only or SHARES:
            cases = given.cases if given.only else max(1, round(given.cases * SHARES[kind]))
            counts = try_all(kind, cases, given.seed, Path(place) / kind)
            report[kind] = together(report[kind], counts) if given.add and kind in report else counts
    OUT.write_text(json.dumps(report, indent=2) + "\n")
    print(json.dumps(report, indent=2))
    return 1 if any(report[kind][fault] for kind in report for fault in FAULTS) else 0


if __name__ == "__main__":
    sys.exit(main())
