"""The picture of forces over a period."""

from conftest import BODIES

from explorer import plot
from explorer.portrait.contact_forces import contact_forces


def test_the_legend_says_how_long_the_table_would_have_to_pull():
    several = contact_forces(BODIES["hoop"], [0.3, 0.1])
    figure = plot.contact_forces(several)
    for text, each in zip(figure.legends[0].get_texts(), several, strict=True):
        assert text.get_text().endswith(f"pulled {100 * each.airborne:.0f} % of the time")
