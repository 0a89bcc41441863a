"""The misprints of the paper: where, the printed form and the right one. Statements decide them by numbers."""

from collections.abc import Iterable
from typing import NamedTuple

from explorer.paper.statement import FACTOR, Finding, Statement, shown

_SHOWN = 1e-7  # what is smaller may be rounding, which differs between machines


class Misprint(NamedTuple):
    """Both forms, in the paper's symbols."""

    printed: str
    right: str


# By section, equation or proof: the key that findings use in `printed`.
MISPRINTS: dict[str, Misprint] = {
    "2.2, 2.4": Misprint("A e₃ ≠ e₃", "A e₃ ≠ ±e₃"),
    "(2.12), last term": Misprint("+ m g u×s", "+ m g s×u (as printed gravity pulls up)"),
    "(2.32) and end of 3.4": Misprint("rotation by φ + π/2", "rotation by π/2 − φ"),
    "(2.35)": Misprint(
        "p = r (1−σ₁²)^(−1/2) σ₁ v + a",
        "p = r (1−σ₁²)^(−1/2) (σ₁ v − e₃) + a (the horizontal part is right as printed)",
    ),
    "3.4, substitution": Misprint("σ₁ = cos φ", "σ₁ = sin φ"),
    "3.4, contact point": Misprint("p = −r A(0) e₁ + a(0)", "p = +r A(0) e₁ + a(0)"),
    "3.4, centre of mass": Misprint("a(t) = r A(t) e₁", "a(t) = −r A(t) e₁"),
    "4, vector field C": Misprint("c (1−z²)⁻¹ ∂/∂y", "c (1−z²)⁻¹ x ∂/∂y"),
    "Lemma 2, proof": Misprint("ũ = ∫₀ᶻ u", "ũ = 1 + ∫₀ᶻ u"),
    "Lemma 3, end of proof": Misprint("(6.8) implies (6.3)", "(6.8) implies (6.4)"),
    "(6.7)": Misprint("+ O(1)", "+ O(ln(1∓z))"),
    "(6.8)": Misprint("+ O((1∓z)^(1/2))", "+ O((1∓z)^(−1/2))"),
    "Lemma 4, proof": Misprint("∓π/2, W(∓1)", "±π/2, W(±1)"),
    "Lemma 4, end": Misprint(
        "the extension has a strict local minimum at ±π/2", "the minimum is one-sided: among |φ| ≤ π/2"
    ),
    "Proposition 1, proof": Misprint("E = ½ φ̇² + V", "E = ½ M φ̇² + V, M = I₁ + m r²"),
    "(7.6)": Misprint("± d ε² cos³φ", "± d ε² / cos³φ, as in (7.13)"),
    "Lemma 5, proof": Misprint("E − V_q(−1)", "E − V_q(±1)"),
    "after Lemma 5, acceleration": Misprint("φ̈ ∼ ±m g r", "φ̈ ∼ ±m g r / (I₁ + m r²)"),
    "after Lemma 5, period": Misprint(
        "2^(3/2) (I₁+mr²)^(−1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
        "2^(3/2) (I₁+mr²)^(+1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
    ),
    "Lemma 6, orders": Misprint("χ̇ of order ±1/η±, ψ̇ of order 1/η±", "χ̇ of order 1/η±, ψ̇ of order ±1/η±"),
    "Lemma 7, proof": Misprint("|ε| ≪ 1±z ≪ 1", "|ε| ≪ 1∓z ≪ 1"),
    "7.3, angle of p − a": Misprint(
        "from χ↓ ± π to χ↑ ± π", "from χ↓ to χ↑ (upper sign), from χ↓ + π to χ↑ + π (lower)"
    ),
    "captions of Figs. 8 and 9": Misprint(
        "η₊/(I₃ r(0)) = 0.01 (left) and 0.01 (right)", "0.01 (left) and −0.01 (right)"
    ),
}


def misprints_page(checked: Iterable[tuple[Statement, Iterable[Finding]]]) -> str:
    """The page of misprints, Markdown: for each the first comparison that decides it, with few digits."""
    deciding: dict[str, tuple[Statement, Finding]] = {}
    for statement, findings in checked:
        for finding in findings:
            for where in finding.printed:
                deciding.setdefault(where, (statement, finding))
    lines = [
        "# Misprints in the paper",
        "",
        "Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*, Regul. Chaotic Dyn. 11 (2006) "
        "31–60.",
        "",
        "Each is decided by a number that a statement of [statements.md](statements.md) compares: how far the "
        f"printed form is off and how far the right one. The first must be at least {FACTOR:g} times what the "
        "second is allowed. Off by less than 1e-07: only what is allowed is shown.",
        "",
        "| where | printed | right | statement | compared | printed is off by | right is off by |",
        "|---|---|---|---|---|---|---|",
    ]
    for where, misprint in MISPRINTS.items():
        if where not in deciding:
            lines.append(f"| {where} | {misprint.printed} | {misprint.right} | none | nothing | | |")
            continue
        statement, finding = deciding[where]
        compared = f"{finding.computed}; expected {shown(finding.expected)}"
        numbers = f"{finding.printed[where]:.2g}", _small(finding)
        cells = (where, *misprint, f"{statement.number} {statement.name}", compared, *numbers)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _small(finding: Finding) -> str:
    """How far the right form is off, or, where that may be rounding, what it is allowed."""
    if finding.error >= _SHOWN:
        return f"{finding.error:.2g}"
    return f"< {finding.tolerance:.0e}" if finding.tolerance else "at most 0"
