"""The bifurcation diagram with its portraits."""

from conftest import BODIES

from explorer import plot
from explorer.portrait.bifurcation_portraits import bifurcation_portraits


def test_each_place_has_its_letter_in_the_diagram_and_over_its_portrait():
    found = bifurcation_portraits(BODIES["hoop"], "line")
    figure = plot.bifurcation_portraits(found)
    diagram, *portraits = figure.axes
    titles = [ax.get_title() for ax in portraits]
    assert [title.partition(":")[0] for title in titles] == ["A", "B", "C"]
    assert [float(title.partition(":")[2]) for title in titles] == [
        float(f"{place:.3g}") for place in found.places
    ]
    low, high = diagram.get_xlim()
    assert all(low < place < high for place in found.places)
    assert plot.caption_of(figure).text.count("Above:") == 1
