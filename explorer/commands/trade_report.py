"""The report of `nearflat trade`: tables, what was measured in words, and the picture."""

import platform
from collections.abc import Iterable, Sequence
from pathlib import Path

from explorer.motion.work_precision import Measured
from explorer.scenes.scene import Scene

_REFERENCE = {
    "passages": "quadrature along arcs at 1e-11, which uses none of the precomputed tables of the methods",
    "tilts": "quadrature at 1e-13; quadrature itself against rk8 with steps far finer than any accuracy needs",
    "motions": "rk8 with steps far finer than any accuracy needs",
}

_ABOUT = """Samples are those that the scene draws. Times are those of the scene's calls, or of `simulate` for
motions: processor time of one core, without compile time, the least of several interleaved rounds.
Compare them only within this page. *Unresolved* is the share of samples whose side of the falling set F is
unknown, *refused* the share without an answer for another reason. *Wrong way* counts samples that came out on
the other side of F. Rows marked * are the best integrators: no other is as fast and as accurate.

![error and time of all methods](trade.png)
"""


def tables(parts: Iterable[Measured]) -> list[str]:
    """All parts as Markdown: what was measured, and its table."""
    lines = []
    for part in parts:
        lines += [
            f"## {part.kind.capitalize()}",
            "",
            f"{part.samples:,} {part.kind}, {part.known:,} with a known answer. Error: {part.error}, against",
            f"{_REFERENCE[part.kind]}.",
            "",
            *by_accuracy(part),
            "",
        ]
    return lines[:-1]


def by_accuracy(part: Measured) -> list[str]:
    """Every method from coarse to fine; the front is marked."""
    heads = "method|accuracy|median error|99th percentile|largest|evaluations|ns per " + part.unit
    rows = [
        f"{row.method}|{row.accuracy:.0e}|{row.median:.0e}|{row.p99:.0e}|{row.largest:.0e}"
        f"|{f'{row.evaluations:.0f}' if row.evaluations else '-'}|{row.nanoseconds:.0f}"
        f"|{row.unresolved:.1%}|{row.refused:.1%}|{row.wrong_way}|{'*' if row.on_front else ''}"
        for row in part.rows
    ]
    return _table([f"{heads}|unresolved|refused|wrong way|*", *rows])


def _table(rows: Sequence[str]) -> list[str]:
    """Markdown of rows whose cells are apart by bars, the head first."""
    head, *others = (f"| {' | '.join(row.split('|'))} |" for row in rows)
    return [head, "|---" * (rows[0].count("|") + 1) + "|", *others]


def write(scene: Scene, parts: list[Measured], out: Path, command: str) -> None:
    """README.md and trade.png in the folder `out`."""
    from matplotlib.figure import Figure

    from explorer.pictures.register import save
    from explorer.pictures.style import SIZE
    from explorer.pictures.work_precision import work_precision

    page = [
        f"# Speed against accuracy: {scene.name}, {scene.label}",
        f"\nMade by `{command}` on {platform.machine()}, {platform.system()}.\n",
        _ABOUT,
        *tables(parts),
    ]
    (out / "README.md").write_text("\n".join(page) + "\n", encoding="utf-8")
    figure = Figure(figsize=(SIZE[0], 2.0 * SIZE[1] if len(parts) > 1 else SIZE[1]), layout="constrained")
    for part, ax in zip(parts, figure.subplots(len(parts), 1, sharex=True, squeeze=False)[:, 0], strict=True):
        work_precision(part, ax=ax)
    for ax in figure.axes[:-1]:
        ax.set_xlabel("")
    save(figure, out / "trade.png")
