"""`nearflat trade`: speed against accuracy, measured on passages near F and on motions in time."""

import argparse
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

from explorer.commands import Answer
from explorer.errors import note, positive
from explorer.measure.sampling import Range
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.reference_samples import ReferencePassages, ReferenceSamples, through_time
from explorer.motion.work_precision import Measured, Row, measure
from explorer.paths import own_folder
from explorer.phase.coordinates import coordinates_to_states
from explorer.phase.disk import SYNTAX, Disk
from explorer.scenes.options import BOX, DISK, RANGE, TRUTH, Options, Reader, option, whole_from
from explorer.scenes.race_angles import RaceAngles, start_of
from explorer.scenes.scene import joined
from explorer.scenes.starts import BOX_NEAR_F, ETA_HAT

_OUT = Path("results/trade")
_REFERENCE = {
    "passages": "another quadrature at 1e-11, which uses none of the precomputed tables of the methods",
    "motions": "rk8 with steps far finer than any accuracy needs",
}
_ABOUT = """Times are those of `passages` and `simulate`: processor time of one core, without compile time, the
shortest of several rounds in which the methods take turns. Compare them only within this page. *Unresolved* is the
share of samples whose side of the falling set F is unknown, *refused* the share without an answer for another
reason, and *wrong_way* counts samples that came out on the other side of F. *on_front* is True if no other
integrator is both as fast and as accurate."""
# The columns of a table, with their formats
_COLUMNS = {
    **{"method": "", "accuracy": ".0e", "median": ".0e", "p99": ".0e", "largest": ".0e"},
    **{"evaluations": ".0f", "nanoseconds": ".0f", "unresolved": ".1%", "refused": ".1%"},
    **{"wrong_way": "", "on_front": ""},
}


class Trading(Options):
    """Passages that start near the falling set at the vertical, and motions in time from the same starts."""

    name: ClassVar[str] = "trade"

    disk: Disk = option(DISK, f"disk: {SYNTAX}", default=Disk.uniform())
    # The time of fewer is mostly that of the call.
    samples: int = option(whole_from(256), "number of passages", default=4096)
    seed: int = option(whole_from(0, 2**128 - 1, "S"), "seed of the random streams", default=0)
    box: Any = option(BOX, BOX_NEAR_F, words="phidot=0.5:2,sigma3=-2:2 in natural units")
    eta_hat: Range = option(
        RANGE,
        ETA_HAT,
        words="1e-8:1 natural units",
        follows=lambda self, given: given or (1e-8 * self.disk.rate_unit, self.disk.rate_unit),
    )
    motions: int = option(
        whole_from(0),
        "how many of the samples, counted from the first, are also measured as motions in time; 0 for none",
        default=1024,
    )
    t_end: float | None = option(
        Reader(positive, "T", "float | str"),
        "end of these motions, in the units of the disk",
        words="2.5 natural units, about a passage",
    )
    progress: bool = option(TRUTH._replace(metavar=None), "False prints nothing", default=True)

    @property
    def scene(self) -> RaceAngles:
        """The scene whose samples they are."""
        said = {name: getattr(self, name) for name in ("disk", "samples", "seed", "box", "eta_hat")}
        return RaceAngles(start="near", **said)

    def reference_samples(self) -> list[ReferenceSamples]:
        """The passages, and the motions if some are asked."""
        scene = self.scene
        drawn = joined([block for index in range(scene.chunks) for block in scene.blocks(index)])
        passages = ReferencePassages(self.disk, starts_at_vertical(self.disk, *start_of(drawn)))
        first = {name: values[: self.motions] for name, values in drawn.items()}
        motions = through_time(coordinates_to_states(self.disk, degrees=False, **first), self.t_end)
        return [passages, motions] if self.motions else [passages]


@dataclass(frozen=True, repr=False)
class Trade:
    """Speed against accuracy: what `trade` returns.

    Attributes
    ----------
    scene : Scene
        Whose samples were measured: race-angles.
    parts : list of Measured
        Passages, and motions in time.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade(disk="hoop", samples=1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in found.rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    scene: RaceAngles
    parts: list[Measured]

    @property
    def rows(self) -> list[Row]:
        """Every method at every accuracy, of all parts."""
        return [row for part in self.parts for row in part.rows]

    def __repr__(self) -> str:
        parts = ", ".join(f"{part.samples:,} {part.kind}" for part in self.parts)
        return f"Trade of {self.scene.name}, {self.scene.label}: {parts}; print it for its tables"

    def __str__(self) -> str:
        return "\n\n".join("\n".join([f"## {part.kind.capitalize()}", "", *_lines(part)]) for part in self.parts)


def measured(chosen: Trading) -> Trade:
    """What `ex.trade` returns. Raises InputError."""
    parts = [
        measure(samples, lambda text: note(text, not chosen.progress)) for samples in chosen.reference_samples()
    ]
    return Trade(chosen.scene, parts)


def _lines(part: Measured) -> list[str]:
    """What was measured, in words and as a Markdown table."""
    cells = [[format(getattr(row, name), form) for name, form in _COLUMNS.items()] for row in part.rows]
    return [
        f"{part.samples:,} {part.kind}, {part.known:,} with a known answer. Error: {part.error}, against",
        f"{_REFERENCE[part.kind]}. *nanoseconds*: for a {part.unit}.",
        "",
        *(f"| {' | '.join(line)} |" for line in ([*_COLUMNS], ["---"] * len(_COLUMNS), *cells)),
    ]


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat trade`."""
    Trading.add_to(command)
    command.add_argument("--out", metavar="DIR", type=Path, default=_OUT, help=f"folder (default {_OUT})")


def call(options: argparse.Namespace) -> Answer:
    """Measure, and write README.md and trade.png."""
    from matplotlib.figure import Figure

    from explorer.commands.pages import write_page
    from explorer.pictures.register import save
    from explorer.pictures.style import SIZE
    from explorer.pictures.work_precision import work_precision

    asked = Trading.of({**Trading.said(options), "progress": not options.quiet})
    out, found = own_folder("out", options.out), measured(asked)
    count = len(found.parts)
    figure = Figure(figsize=(SIZE[0], count * SIZE[1]), layout="constrained")
    for part, ax in zip(found.parts, figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0], strict=True):
        work_precision(part, ax=ax)
        ax.label_outer()
    save(figure, picture := out / "trade.png")
    parts = [("Error and time of all methods", [_ABOUT], [picture])]
    parts += [(part.kind.capitalize(), _lines(part), []) for part in found.parts]
    made_by = f"`{options.command_line}` on {platform.machine()}, {platform.system()}."
    write_page(out, f"Speed against accuracy, {found.scene.label} disk", made_by, parts)
    record = {"scene": found.scene.options, "parts": [asdict(part) for part in found.parts]}
    return Answer(record, f"{found}\n\nTables and picture are in {out}.")
