"""Writes results/measure-zero: the law P(theta_min < delta) = C delta for several bodies and densities."""

import math
import shutil
import sys
import tempfile
from pathlib import Path

import explorer as ex
from explorer.measure.distributions import Distribution

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from small_runs import DELTAS, coverage

OUT = Path(__file__).resolve().parents[2] / "results" / "measure-zero"
HALF_PI = 0.5 * math.pi
CASES = (
    ("uniform", {}),
    ("hoop", {}),
    ("matching", {}),
    ("uniform", {"box": "phi=-1:1"}),
    ("hoop", {"box": "phi=-1:1"}),
    ("matching", {"box": "phi=-1:1"}),
    ("uniform", {"box": f"phi={-HALF_PI!r}:{HALF_PI!r}", "energy": ":3"}),
    ("hoop", {"box": "phi=-0.5:1,sigma4=0.3"}),
    ("uniform", {"box": "phidot=norm:0.5:0.3,sigma4=norm:0:0.5"}),
)
COVERED = (("uniform", None, 256), ("hoop", "phi=-1:1", 256), ("matching", "phi=-1:1", 64))
LAWS = {
    "dimension_two": "P proportional to delta^2, and equal to C delta at delta = 1e-4",
    "plateau": "C delta + 1e-6",
    "constant_off": "1.02 C delta",
}


def described(options):
    text = ", ".join(f"{key} {value}" for key, value in options.items())
    return text.replace(repr(HALF_PI), "pi/2").replace(repr(-HALF_PI), "-pi/2") or "the vertical, rates within 2"


def case_row(disk, options, summary):
    slope, constant = summary["slope"], summary["constant"]
    half = 0.5 * (constant["interval_95"][1] - constant["interval_95"][0]) / constant["value"]
    off = (constant["value"] - summary["constant_predicted"]) / constant["error"]
    slope_half = 0.5 * (slope["interval_95"][1] - slope["interval_95"][0])
    return (
        f"| {disk} | {described(options)} | {summary['constant_predicted']:.6f} | {constant['value']:.5f} | "
        f"{half:.1e} | {off:+.1f} | {slope['value']:.6f} | {slope_half:.0e} | {summary['p_value']['law']:.2g} |"
    )


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Falling has measure zero",
        "",
        "Made by `python tests/tools/report_measure_zero.py`. It runs `nearflat run measure-zero` with the",
        "defaults: 4 × 10^6 *plain* draws from the whole range of starts (the *box*). In addition, at each tilt "
        "delta",
        "from 1e-1 to 1e-15, it has 2^18 draws close to the falling set F (in *tubes*) for each face of the",
        "disk. These tilts are the *ladder*, and each is a *rung*. No disk fell in any run, so in each the",
        "probability of falling is below 7.5e-7 (95 %). For small delta the probability to come flatter than",
        "delta is C delta; C is fitted on delta <= 1e-4. *z*: the difference from the prediction in standard",
        "errors. *+-*: the half-width of the 95 % interval; for C, divided by C. *Slope*: the power of delta "
        "that fits",
        "best; the law predicts 1. *p*: the p-value of the law.",
        "",
        "| disk | density | C predicted | C estimated | +- | z | slope | +- | p |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for number, (disk, options) in enumerate(CASES):
            run = ex.run("measure-zero", disk=disk, out=Path(folder) / str(number), **options)
            assert run.summary["falls"] == 0
            lines.append(case_row(disk, options, run.summary))
            print(lines[-1], flush=True)
            if number == 0:
                first = run.summary
                shutil.copy(run.folder / "figures" / "ladder.png", OUT / "ladder.png")
    lines += ["", "## The ladder of the first row", "", "![ladder](ladder.png)", ""]
    lines += [*ladder_lines(first), *law_lines(first), "", *coverage_lines()]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def ladder_lines(summary):
    yield (
        "| delta | plain draws flatter than delta | P by plain draws, 95 % interval | P by tubes, divided by "
        "delta | 95 % interval that holds for all rungs together | effective size |"
    )
    yield "|---|---|---|---|---|---|"
    for row in summary["ladder"]:
        delta, (low, high) = row["delta"], row["plain"]["interval_95"]
        tube = [end / delta for end in row["interval_95_simultaneous"]]
        yield (
            f"| {delta:g} | {row['count']:,} | {low:.2e} to {high:.2e} | {row['estimate'] / delta:.5f} | "
            f"{tube[0]:.5f} to {tube[1]:.5f} | {row['effective_sample_size']:,.0f} |"
        )


def law_lines(summary):
    yield from ("", "## Wrong laws", "", "| law | p-value |", "|---|---|")
    for name, text in LAWS.items():
        yield f"| {text} | {summary['p_value'][name]:.2g} |"
    yield ""
    yield "If the second law of this table held, some disks would fall although they start far from F. Draws in"
    yield "tubes cannot show this. Plain draws can, but it takes some seven million to reject this law."


def coverage_lines():
    yield from ("## Do the intervals cover?", "")
    depths = ", ".join(f"{delta:g}" for delta in DELTAS)
    yield f"400 small runs each, rungs at {depths}; share of 95 % intervals that contain the truth."
    yield from ("", "| disk | box | draws per rung and face | C | slope | a rung |", "|---|---|---|---|---|---|")
    for name, box, draws in COVERED:
        disk = ex.Disk.parse(name)
        shares = coverage(Distribution.invariant(disk, box), 400, draws, seed=12)
        cells = " | ".join(f"{share:.3f}" for share in shares)
        yield f"| {name} | {box or 'the vertical'} | {draws} | {cells} |"


if __name__ == "__main__":
    main()
