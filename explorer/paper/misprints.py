"""The misprints of the paper: where, the printed form, the right one, and the numbers that decide."""

from collections.abc import Callable
from dataclasses import dataclass

from explorer.paper import misprint_evidence as motions
from explorer.paper import misprint_limits as limits
from explorer.paper.misprint_evidence import FACTOR, Evidence

_SHOWN = 1e-7  # what is smaller may be rounding, which differs between machines


@dataclass(frozen=True)
class Misprint:
    """One misprint. where: section, equation or proof; decide: computes the evidence."""

    where: str
    printed: str
    right: str
    decide: Callable[[], Evidence]


MISPRINTS: tuple[Misprint, ...] = (
    Misprint("2.2, 2.4", "A e₃ ≠ e₃", "A e₃ ≠ ±e₃", motions.excluded_attitudes),
    Misprint("(2.12), last term", "+ m g u×s", "+ m g s×u (as printed gravity pulls up)", motions.gravity_term),
    Misprint("(2.32) and end of 3.4", "rotation by φ + π/2", "rotation by π/2 − φ", motions.euler_angle),
    Misprint(
        "(2.35)",
        "p = r (1−σ₁²)^(−1/2) σ₁ v + a",
        "p = r (1−σ₁²)^(−1/2) (σ₁ v − e₃) + a (the horizontal part is right as printed)",
        motions.contact_point,
    ),
    Misprint("3.4, substitution", "σ₁ = cos φ", "σ₁ = sin φ", motions.special_sigma1),
    Misprint("3.4, contact point", "p = −r A(0) e₁ + a(0)", "p = +r A(0) e₁ + a(0)", motions.special_contact),
    Misprint("3.4, centre of mass", "a(t) = r A(t) e₁", "a(t) = −r A(t) e₁", motions.special_centre),
    Misprint("4, vector field C", "c (1−z²)⁻¹ ∂/∂y", "c (1−z²)⁻¹ x ∂/∂y", motions.field_C),
    Misprint("Lemma 2, proof", "ũ = ∫₀ᶻ u", "ũ = 1 + ∫₀ᶻ u", limits.regular_part),
    Misprint("Lemma 3, end of proof", "(6.8) implies (6.3)", "(6.8) implies (6.4)", limits.lemma_3_end),
    Misprint("(6.7)", "+ O(1)", "+ O(ln(1∓z))", limits.remainder_of_W),
    Misprint("(6.8)", "+ O((1∓z)^(1/2))", "+ O((1∓z)^(−1/2))", limits.order_of_gravity),
    Misprint("Lemma 4, proof", "∓π/2, W(∓1)", "±π/2, W(±1)", limits.lemma_4_end),
    Misprint(
        "Lemma 4, end",
        "the extension has a strict local minimum at ±π/2",
        "the minimum is one-sided: among |φ| ≤ π/2",
        limits.lemma_4_minimum,
    ),
    Misprint("Proposition 1, proof", "E = ½ φ̇² + V", "E = ½ M φ̇² + V, M = I₁ + m r²", motions.energy_of_phi),
    Misprint("(7.6)", "± d ε² cos³φ", "± d ε² / cos³φ, as in (7.13)", limits.derivative_near_flat),
    Misprint("Lemma 5, proof", "E − V_q(−1)", "E − V_q(±1)", limits.energy_near_flat),
    Misprint(
        "after Lemma 5, acceleration", "φ̈ ∼ ±m g r", "φ̈ ∼ ±m g r / (I₁ + m r²)", limits.acceleration_near_flat
    ),
    Misprint(
        "after Lemma 5, period",
        "2^(3/2) (I₁+mr²)^(−1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
        "2^(3/2) (I₁+mr²)^(+1/2) (m g r)⁻¹ (E−V₀)^(1/2)",
        limits.period_in_the_well,
    ),
    Misprint(
        "Lemma 6, orders",
        "χ̇ of order ±1/η±, ψ̇ of order 1/η±",
        "χ̇ of order 1/η±, ψ̇ of order ±1/η±",
        limits.orders_of_rates,
    ),
    Misprint("Lemma 7, proof", "|ε| ≪ 1±z ≪ 1", "|ε| ≪ 1∓z ≪ 1", limits.small_quantity),
    Misprint(
        "7.3, angle of p − a",
        "from χ↓ ± π to χ↑ ± π",
        "from χ↓ to χ↑ (upper sign), from χ↓ + π to χ↑ + π (lower)",
        motions.contact_angle,
    ),
    Misprint(
        "captions of Figs. 8 and 9",
        "η₊/(I₃ r(0)) = 0.01 (left) and 0.01 (right)",
        "0.01 (left) and −0.01 (right)",
        limits.eta_of_right_panels,
    ),
)


def misprints_page() -> str:
    """The page of misprints, Markdown; the same on every machine, since digits are few."""
    lines = [
        "# Misprints in the paper",
        "",
        "Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*, Regul. Chaotic Dyn. 11 (2006) "
        "31–60.",
        "",
        "Each is decided by a number: how far the printed form is off and how far the right one. "
        f"The first must be at least {FACTOR:g} times what the second is allowed. Off by less than 1e-07: only "
        "what is allowed is shown. Units m = r = g = 1 and the uniform disk, unless said otherwise.",
        "",
        "| where | printed | right | computed | printed is off by | right is off by |",
        "|---|---|---|---|---|---|",
    ]
    for row in MISPRINTS:
        found = row.decide()
        numbers = (f"{found.printed:.2g}", _small(found))
        cells = (row.where, row.printed, row.right, found.compared, *numbers)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _small(found: Evidence) -> str:
    return f"{found.right:.2g}" if found.right >= _SHOWN else f"< {found.bound:.0e}"
