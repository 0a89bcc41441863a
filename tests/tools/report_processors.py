"""Writes results/processors/: what of a run is the same on which kind of processor.

    python tests/tools/report_processors.py      # some minutes; Linux on x86-64

Other kinds are imitated: numba compiles for them, numpy and the C library leave out what they do not have.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

OUT = Path(__file__).parents[2] / "results" / "processors"
SCENES = {
    "race-angles": {"samples": 100_000, "chunk_size": 32_768, "eta_hat": "1e-9:1e-2", "keep": "all"},
    "falling-set": {"samples": 100_000, "chunk_size": 32_768, "grid": 3, "keep": "all"},
}
# What numpy and glibc choose anew on every start, without any compilation.
_NO_512 = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512DQ,-AVX512BW,-AVX512CD",
}
_NO_FMA = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512DQ,-AVX512BW,-AVX512CD,-AVX2,-FMA,-FMA4",
}


def _kernels_for(name, features=""):
    """What numba is told to compile for a kind of processor; else it adds all that this one has."""
    return {"NUMBA_CPU_NAME": name, "NUMBA_CPU_FEATURES": features}


KINDS = {
    "this one": {},
    "x86-64-v3 (haswell: AVX2, fused), numpy and libm too": {**_kernels_for("haswell", "+avx2,+fma"), **_NO_512},
    "this one, numpy without AVX-512": {"NPY_DISABLE_CPU_FEATURES": _NO_512["NPY_DISABLE_CPU_FEATURES"]},
    "this one, libm without fused products": {"GLIBC_TUNABLES": _NO_FMA["GLIBC_TUNABLES"]},
    "this one, numpy without AVX2 and fused products": {
        "NPY_DISABLE_CPU_FEATURES": _NO_FMA["NPY_DISABLE_CPU_FEATURES"]
    },
    "x86-64 (generic: nothing fused), numpy and libm too": {**_kernels_for("x86-64"), **_NO_FMA},
}
_UNITS = {"angles": "rad", "other numbers": "(relative)", "error estimates": "(relative)"}
_ANGLES = ("delta_chi", "delta_psi", "race_angle", "fall_angle", "chi", "psi")


def compute(target):
    """All chunks of every scene, into one file of arrays for each, with counts and digest; only used kernels."""
    from explorer.runs import store
    from explorer.runs.machine import machine
    from explorer.scenes.scene import scene_class

    said = {"machine": machine()}
    for name, options in SCENES.items():
        scene = scene_class(name).of(options)
        tables, tallies, digests = [], [], []
        for index in range(scene.chunks):
            kept, counts = scene.chunk(index)
            tally = json.loads(json.dumps(counts.state()))
            tables.append(kept)
            tallies.append(tally)
            digests.append(store.digest_of(kept, tally))
        np.savez(target / f"{name}.npz", **{key: np.concatenate([t[key] for t in tables]) for key in tables[0]})
        said[name] = {"tallies": tallies, "digest": store.sha256("".join(digests))}
    (target / "said.json").write_text(json.dumps(said))


def whole_numbers(value, path=""):
    """The counts in a tally, by where they stand; sums of doubles are left out."""
    if isinstance(value, dict | list):
        entries = value.items() if isinstance(value, dict) else enumerate(value)
        return {k: v for key, each in entries for k, v in whole_numbers(each, f"{path}/{key}").items()}
    return {path: value} if isinstance(value, int) else {}


def compare(name, here, there):
    """One cell: digest, counts and the largest differences of rows against those of this processor."""
    said, ours = (json.loads((place / "said.json").read_text())[name] for place in (there, here))
    if said["digest"] == ours["digest"]:
        return "the same digest"
    counts, before = whole_numbers(said["tallies"]), whole_numbers(ours["tallies"])
    moved = [key for key in {**before, **counts} if counts.get(key) != before.get(key)]
    estimates = sum("error_estimate" in key for key in moved)
    table, reference = np.load(there / f"{name}.npz"), np.load(here / f"{name}.npz")
    apart = {}
    for key in reference.files:
        a, b = reference[key], table[key]
        if a.shape != b.shape:
            return "other digest, other rows"
        if a.dtype.kind == "f":
            apart[key] = differences(key, a, b)
        elif (a != b).any():
            moved.append(key)
    largest = {kind: max((d[1] for d in apart.values() if d[0] == kind), default=0.0) for kind in _UNITS}
    rows = max(share for _, _, share in apart.values())
    counted = "the same counts" if len(moved) == estimates else f"{len(moved) - estimates} counts differ"
    counted += f" but for {estimates} bins of error estimates" if estimates else ""
    sizes = ", ".join(f"{kind} by {size:.0e} {_UNITS[kind]}" for kind, size in largest.items() if size > 0.0)
    return f"other digest, {counted}; {rows:.2%} of rows differ in some column{': ' if sizes else ''}{sizes}"


def differences(key, a, b):
    """What kind of column it is, the largest difference, and in what share of rows there is one."""
    with np.errstate(all="ignore"):
        apart = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, abs(a - b))
        relative = np.where(apart > 0.0, apart / np.maximum(abs(a), 1e-300), 0.0)
    if key == "error_estimate":
        return "error estimates", float(relative.max()), float((apart > 0.0).mean())
    kind = "angles" if key in _ANGLES else "other numbers"
    return kind, float((apart if kind == "angles" else relative).max()), float((apart > 0.0).mean())


def run(kind, place):
    """One kind of processor in a process of its own; kinds with the same kernels compile them once."""
    target = Path(tempfile.mkdtemp(dir=place))
    command = [sys.executable, __file__, "--compute", str(target)]
    environment = {**os.environ, **KINDS[kind]}
    if "NUMBA_CPU_NAME" in environment:
        environment["NUMBA_CACHE_DIR"] = str(place / f"cache of {environment['NUMBA_CPU_NAME']}")
    done = subprocess.run(command, env=environment, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"{kind}: exit status {done.returncode}\n{done.stderr[-2000:]}")
    return target


def main():
    with tempfile.TemporaryDirectory() as name:
        place, rows, found = Path(name), [], {}
        for kind in KINDS:
            found[kind] = there = run(kind, place)
            known = json.loads((there / "said.json").read_text())["machine"]["arithmetic"]
            cells = [compare(scene, found["this one"], there) for scene in SCENES]
            rows.append(f"| {kind} | `{known}` | {' | '.join(cells)} |")
            print(rows[-1], flush=True)
    OUT.mkdir(parents=True, exist_ok=True)
    said = "; ".join(f"{name}: {options['samples']:,} samples" for name, options in SCENES.items())
    lines = [
        "# Kinds of processor",
        "",
        "Made by `python tests/tools/report_processors.py` on "
        f"{platform.machine()}, {' '.join(platform.libc_ver())}, numpy {np.__version__}. {said}. Every row is",
        "compared with the first. *Fused*: a product and a sum are rounded only once. Other kinds of processor "
        "are",
        "imitated: kernels are compiled for them,",
        "and numpy and the C library are kept from using instructions that these processors lack.",
        "",
        "| kind | `arithmetic` in run.json | " + " | ".join(SCENES) + " |",
        "|---|---|" + "---|" * len(SCENES),
        *rows,
    ]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--compute", type=Path)
    given = parser.parse_args()
    compute(given.compute) if given.compute else main()
