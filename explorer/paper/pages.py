"""`nearflat paper`: every statement checked, every figure drawn, every misprint shown with its evidence."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.errors import jobs_of, note
from explorer.paper import (
    figure_numbers,
    section_2,
    section_3_4,
    section_5,
    section_6_1,
    section_6_2,
    section_6_3,
    section_7_1,
    section_7_3,
)
from explorer.paper.figures import FIGURES, figure
from explorer.paper.statement import ETA_HAT, FACTOR, Finding, Statement, chosen, shown
from explorer.paths import made_folder, own_folder, path_of
from explorer.phase.disk import Disk
from explorer.pictures.register import save

# The statements of these are registered as they are imported.
SECTIONS = (
    *(section_2, section_3_4, section_5, section_6_1, section_6_2, section_6_3, section_7_1, section_7_3),
    figure_numbers,
)

# By section, equation or proof, which findings use in `printed`: the printed form and the right one.
MISPRINTS = {
    "2.2, 2.4": ("A e₃ ≠ e₃", "A e₃ ≠ ±e₃"),
    "(2.12), last term": ("+ m g u×s", "+ m g s×u (as printed gravity pulls up)"),
    "(2.32) and end of 3.4": ("rotation by φ + π/2", "rotation by π/2 − φ"),
    "(2.35)": (
        "p = r (1−σ₁²)^(−1/2) σ₁ v + a",
        "p = r (1−σ₁²)^(−1/2) (σ₁ v − e₃) + a (the horizontal part is right as printed)",
    ),
    "3.4, substitution": ("σ₁ = cos φ", "σ₁ = sin φ"),
    "3.4, contact point": ("p = −r A(0) e₁ + a(0)", "p = +r A(0) e₁ + a(0)"),
    "3.4, centre of mass": ("a(t) = r A(t) e₁", "a(t) = −r A(t) e₁"),
    "4, vector field C": ("c (1−z²)⁻¹ ∂/∂y", "c (1−z²)⁻¹ x ∂/∂y"),
    "Lemma 2, proof": ("ũ = ∫₀ᶻ u", "ũ = 1 + ∫₀ᶻ u"),
    "Lemma 3, end of proof": ("(6.8) implies (6.3)", "(6.8) implies (6.4)"),
    "(6.7)": ("+ O(1)", "+ O(ln(1∓z))"),
    "(6.8)": ("+ O((1∓z)^(1/2))", "+ O((1∓z)^(−1/2))"),
    "Lemma 4, proof": ("∓π/2, W(∓1)", "±π/2, W(±1)"),
    "Lemma 4, end": (
        "the extension has a strict local minimum at ±π/2",
        "the minimum is one-sided: among |φ| ≤ π/2",
    ),
    "Proposition 1, proof": ("E = ½ φ̇² + V", "E = ½ M φ̇² + V, M = I₁ + m r²"),
    "(7.6)": ("± d ε² cos³φ", "± d ε² / cos³φ, as in (7.13)"),
    "Lemma 5, proof": ("E − V_q(−1)", "E − V_q(±1)"),
    "after Lemma 5, acceleration": ("φ̈ ∼ ±m g r", "φ̈ ∼ ±m g r / (I₁ + m r²)"),
    "after Lemma 5, period": (
        "2^(3/2) (I₁+mr²)^(−1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
        "2^(3/2) (I₁+mr²)^(+1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
    ),
    "Lemma 6, orders": ("χ̇ of order ±1/η±, ψ̇ of order 1/η±", "χ̇ of order 1/η±, ψ̇ of order ±1/η±"),
    "Lemma 7, proof": ("|ε| ≪ 1±z ≪ 1", "|ε| ≪ 1∓z ≪ 1"),
    "7.3, angle of p − a": (
        "from χ↓ ± π to χ↑ ± π",
        "from χ↓ to χ↑ (upper sign), from χ↓ + π to χ↑ + π (lower)",
    ),
    "captions of Figs. 8 and 9": ("η₊/(I₃ r(0)) = 0.01 (left) and 0.01 (right)", "0.01 (left) and −0.01 (right)"),
}

_EACH = 10  # statements after which a line says how far the checks are
_ROUNDING = 1e-7  # what is smaller may be rounding, which differs between machines


@dataclass(frozen=True)
class Checked:
    """A statement with its findings; `trouble` says why it could not be computed."""

    statement: Statement
    findings: tuple[Finding, ...]
    trouble: str | None = None

    @property
    def passed(self) -> bool:
        return self.trouble is None and bool(self.findings) and all(f.passed for f in self.findings)

    def describe(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "number": self.statement.number,
            "name": self.statement.name,
            "statement": self.statement.text,
            "verdict": verdict(self.passed),
            "trouble": self.trouble,
            "findings": [
                asdict(f)
                | {"measured": shown(f.measured), "expected": shown(f.expected), "verdict": verdict(f.passed)}
                | {"error": f.error if math.isfinite(f.error) else None}
                for f in self.findings
            ],
        }


def verdict(passed: bool) -> str:
    """How a row or a finding came out, in a word."""
    return "holds" if passed else "FAILS"


def check_row(row: Statement) -> Checked:
    """Compute one statement. Whatever goes wrong in it is a failure of that row alone."""
    try:
        return Checked(row, tuple(row.check()))
    except Exception as error:
        return Checked(row, (), f"{type(error).__name__}: {error}")


def check_all(only: str | None = None, jobs: int = 2, quiet: bool = True) -> list[Checked]:
    """Check all statements, or one, and say how far it is. Raises InputError where `only` names none of them."""
    from joblib import Parallel, delayed

    rows = chosen(only)
    if only is None:
        compiled.warmup()  # one statement calls few kernels, and compiles these as it comes to them
    done = []
    side_by_side = Parallel(n_jobs=jobs, backend="threading", return_as="generator")
    for row in side_by_side(delayed(check_row)(statement) for statement in rows):
        done.append(row)
        if len(done) % _EACH == 0:
            note(f"checked {len(done)} of {len(rows)}", quiet)
    return done


def paper(out: Path | str, *, only: str | None = None, jobs: int = 2, quiet: bool = True) -> list[Checked]:
    """Check the statements; all of them, then write statements.md, misprints.md and the figures.

    Raises InputError for an unknown statement or a folder that cannot be written.
    """
    jobs, folder = jobs_of("jobs", jobs), path_of("out", out)
    if only is None:
        own_folder("out", folder)
    note("checking the statements", quiet)
    rows = check_all(only, jobs, quiet)
    if only is None:
        pages = {"statements.md": statements_page(rows), "misprints.md": misprints_page(rows)}
        for name, page in pages.items():
            (folder / name).write_text(page, encoding="utf-8")
        for number in FIGURES:
            note(f"drawing figure {number}", quiet)
            one_figure(folder, number)
    return rows


def one_figure(folder: Path | str, number: int, disk: Disk | None = None, eta_hat: float = ETA_HAT) -> list[Path]:
    """Draw one figure, of the paper's own body or of another, into figures/ of a folder; returns the files.

    Raises InputError.
    """
    where = made_folder("out", path_of("out", folder) / "figures")
    drawn = figure(number, disk, eta_hat)
    name = f"figure-{number}"
    if disk is not None or eta_hat != ETA_HAT:
        name += f"-{(disk or FIGURES[number].disk).name}-{eta_hat:g}"
    paths = [where / f"{name}.{kind}" for kind in ("png", "svg")]
    for path in paths:
        save(drawn, path)
    return paths


def statements_page(rows: Sequence[Checked]) -> str:
    """The statements with what was computed, measured and expected, as Markdown."""
    failed = [row.statement.name for row in rows if not row.passed]
    lines = [
        "# The statements of the paper, checked",
        "",
        "Made by `nearflat paper`. Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*,",
        "Regul. Chaotic Dyn. 11 (2006) 31-60. [corrected]: as `misprints.md` says.",
        "",
        "Each comparison gives what was computed, the number that came out, the one that the paper leads to, how",
        "far they are apart (compared), how far they may be (at most) and why that much (because).",
        "",
        f"{len(rows) - len(failed)} of {len(rows)} hold." + (f" Failing: {', '.join(failed)}." if failed else ""),
    ]
    head = ("computed", "measured", "expected", "compared", "at most", "because", "")
    for row in rows:
        heading = f"## {row.statement.number}. {row.statement.name}: {verdict(row.passed)}"
        lines += ["", heading, "", row.statement.text]
        if row.trouble is not None:
            lines += ["", f"Could not be computed: {row.trouble}"]
        lines += _table(head, map(_cells, row.findings)) if row.findings else []
    return "\n".join(lines) + "\n"


def misprints_page(rows: Iterable[Checked]) -> str:
    """The misprints, as Markdown: for each the first comparison that decides it, with few digits."""
    decided: dict[str, tuple[str, ...]] = {}
    for row in rows:
        for finding in row.findings:
            compared = f"{finding.computed}; expected {shown(finding.expected)}"
            for where, off in finding.printed.items():
                name = f"{row.statement.number} {row.statement.name}"
                decided.setdefault(where, (name, compared, f"{off:.2g}", _small(finding)))
    lines = [
        "# Misprints in the paper",
        "",
        "Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*, Regul. Chaotic Dyn. 11 (2006) "
        "31–60.",
        "",
        "Each is decided by a number that a statement of [statements.md](statements.md) compares: how far the "
        f"printed form is off and how far the right one. The first must be at least {FACTOR:g} times what the "
        "second is allowed. Off by less than 1e-07: only what is allowed is shown. *Compared* names a quantity, "
        "what it becomes if the printed formula is used, and the value that the right formula leads to.",
    ]
    head = ("where", "printed", "right", "statement", "compared", "printed is off by", "right is off by")
    none = ("none", "nothing", "", "")
    cells = ((where, *forms, *decided.get(where, none)) for where, forms in MISPRINTS.items())
    return "\n".join([*lines, *_table(head, cells)]) + "\n"


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """A table in Markdown, after an empty line."""
    head, *lines = (" | ".join(cell.replace("|", "\\|") for cell in row) for row in (head, *rows))
    return ["", f"| {head} |", "|---" * (1 + head.count(" | ")) + "|", *(f"| {line} |" for line in lines)]


def _cells(finding: Finding) -> tuple[str, ...]:
    values = finding.computed, shown(finding.measured), shown(finding.expected)
    return *values, f"{finding.error:.1e}", f"{finding.tolerance:.1e}", finding.reason, verdict(finding.passed)


def _small(finding: Finding) -> str:
    """How far the right form is off, or, where that may be rounding, what it is allowed."""
    if finding.error >= _ROUNDING:
        return f"{finding.error:.2g}"
    return f"< {finding.tolerance:.0e}" if finding.tolerance else "at most 0"


def line_of(finding: Finding) -> str:
    """A finding in one line for the terminal."""
    values = f"{shown(finding.measured)}, expected {shown(finding.expected)}"
    off = f"compared {finding.error:.1e}, at most {finding.tolerance:.1e}"
    return f"  {finding.computed}: {values} ({off})"


def headline(rows: Sequence[Checked]) -> Iterator[str]:
    """Lines for the user: what fails, and how many hold."""
    for row in rows:
        if not row.passed:
            yield f"{row.statement.number} {row.statement.name} FAILS: {row.trouble or row.statement.text}"
            yield from (line_of(finding) for finding in row.findings if not finding.passed)
    yield f"{sum(row.passed for row in rows)} of {len(rows)} statements hold."
