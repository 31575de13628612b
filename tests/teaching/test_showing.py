import io

import numpy as np
import pytest
import torch
from matplotlib import pyplot as plt
from PIL import Image

from s2glib.teaching import figure, report
from s2glib.teaching.showing import spoken

CAPTION = "A straight line that rises. Look how it never bends."


@pytest.fixture
def shown(monkeypatch):
    """What a notebook would display."""
    displayed = []
    monkeypatch.setattr(
        "s2glib.teaching.showing.display", lambda data, raw: displayed.append((data, raw))
    )
    return displayed


@pytest.fixture
def drawing():
    fig, axes = plt.subplots(figsize=(3, 2))
    axes.plot([0, 2], [1, 3])
    axes.set(xlabel="time (s)", ylabel="speed (m/s)")
    yield fig
    plt.close(fig)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1 / 3, "0.333"),
        (-1e-17, "0"),
        (1234.5, "1.23e+03"),
        (float("nan"), "nan"),
        (4096, "4096"),
        (True, "True"),
        (np.bool_(False), "False"),
        (np.float32(0.5), "0.5"),
        (torch.eye(2), "((1, 0), (0, 1))"),
        (torch.tensor(2.0, requires_grad=True), "2"),
        (torch.zeros(3, 4).shape, "(3, 4)"),
        ("anger", "anger"),
    ],
)
def test_values_are_said_alike_everywhere(value, text):
    assert spoken(value) == text


def test_a_report_lines_up_names_and_values(capsys):
    report(frames=143, frames_per_second=30.0)
    assert capsys.readouterr().out == "frames            : 143\nframes per second : 30\n"


def test_a_figure_comes_with_its_caption_and_extent(shown, drawing):
    figure(drawing, CAPTION)
    (picture, _), (words, _) = shown
    assert Image.open(io.BytesIO(picture["image/png"])).size == (300, 200)
    assert words["text/plain"] == f"{CAPTION}\ntime (s): 0 to 2; speed (m/s): 1 to 3"
    assert CAPTION in words["text/markdown"]
    assert drawing.number not in plt.get_fignums()


def test_the_extent_of_what_a_network_made_is_left_out(shown, drawing):
    figure(drawing, CAPTION, exact=False)
    assert shown[1][0]["text/plain"] == CAPTION


@pytest.mark.parametrize("axis", ["x", "y"])
def test_an_axis_without_a_label_is_refused(shown, drawing, axis):
    drawing.axes[0].set(**{f"{axis}label": ""})
    with pytest.raises(ValueError, match=f"the {axis} axis"):
        figure(drawing, CAPTION)
    assert shown == []


def test_a_shared_axis_needs_one_label_and_a_hidden_one_none(shown):
    fig, (top, bottom) = plt.subplots(2, 1, sharex=True)
    top.set(ylabel="a (m)")
    bottom.set(ylabel="b (m)", xlabel="time (s)")
    figure(fig, CAPTION)
    fig, axes = plt.subplots()
    axes.axis("off")
    figure(fig, CAPTION)
    assert len(shown) == 4


@pytest.mark.parametrize("caption", ["", "Too short.", "Too long. " * 31])
def test_a_caption_of_another_length_is_refused(drawing, caption):
    with pytest.raises(ValueError, match="40 to 300"):
        figure(drawing, caption)
