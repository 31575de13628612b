import matplotlib
import pytest
from matplotlib.figure import Figure
from test_paper_map import NOTEBOOK_NAMES

from s2glib.viz.systems import STAGES, SYSTEMS, draw_systems

matplotlib.use("Agg")


def test_every_step_is_on_the_map_inside_its_frame():
    axes = Figure().add_subplot()
    assert draw_systems(axes) is axes
    written = {text.get_text() for text in axes.texts}
    for system in SYSTEMS:
        assert {system.name, *(step.what for step in system.steps)} <= written
    boxes = [patch.get_bbox() for patch in axes.patches if hasattr(patch, "get_boxstyle")]
    assert len(boxes) == len(STAGES) * len(SYSTEMS)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert all(left < b.x0 and b.x1 < right and low < b.y0 and b.y1 < high for b in boxes)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_a_step_names_notebooks_that_are_planned(system):
    planned = {name[:2] for name in NOTEBOOK_NAMES}
    assert len(system.steps) == len(STAGES)
    assert {number for step in system.steps for number in step.notebooks.split()} <= planned
