import math
import time
from typing import ClassVar

import ipywidgets
import pytest

from s2glib.widgets import Demo, Panel, Slider
from s2glib.widgets.demo import SLOWEST


class Bars(Demo):
    """A bar as long as two numbers' product."""

    controls: ClassVar = {
        "height": Slider(1, 5, 2, 1),
        "width": Slider(0.5, 2.0, 1.0, 0.5),
        "ink": ["red", "blue"],
    }
    grid: ClassVar = [{"height": 1}, {"height": 5, "width": 2.0}, {"ink": "blue"}]

    def render(self, *, height, width, ink):
        area = height * width
        picture = f'<svg width="100" height="100"><rect fill="{ink}" width="{10 * area}" /></svg>'
        return Panel(picture, f"a {ink} bar of {area:g}", {"area": area})


def texts(demo):
    return [child.value for child in demo.children if isinstance(child, ipywidgets.HTML)]


def test_the_view_follows_a_control():
    demo = Bars()
    demo.set(height=5)
    picture, spoken = texts(demo)
    assert 'width="50.0"' in picture
    assert "a red bar of 5" in spoken


def test_the_description_is_spoken_politely_and_labels_the_picture():
    picture, spoken = texts(Bars())
    assert 'aria-live="polite"' in spoken
    assert 'aria-label="a red bar of 2"' in picture


def test_controls_are_native_and_say_their_names():
    kinds = [type(child).__name__ for child in Bars().children[:3]]
    assert kinds == ["IntSlider", "FloatSlider", "Dropdown"]
    assert [child.description for child in Bars().children[:3]] == ["height", "width", "ink"]


def test_the_selftest_says_one_line_and_restores_the_start(capsys):
    demo = Bars()
    before = demo.state
    demo.selftest()
    assert capsys.readouterr().out == "3 states, 3 distinct\n"
    assert demo.state == before == {"height": 2, "width": 1.0, "ink": "red"}


def test_two_demos_share_no_control():
    first, second = Bars(), Bars()
    first.set(height=5)
    assert second.state["height"] == 2


def test_a_broken_picture_is_an_error_and_not_an_output():
    class Broken(Bars):
        def render(self, *, height, width, ink):
            if height == 4:
                raise RuntimeError("boom")
            return super().render(height=height, width=width, ink=ink)

    with pytest.raises(RuntimeError, match="boom"):
        Broken().set(height=4)


def stuck(panel, state):
    return panel._replace(picture="always the same")


def endless(panel, state):
    return panel._replace(facts={"area": math.inf})


def wordless(panel, state):
    return panel._replace(alt="")


def moody(panel, state, calls=[]):  # noqa: B006
    calls.append(0)
    return panel._replace(picture=str(len(calls)))


def slow(panel, state):
    began = time.process_time()
    while time.process_time() - began < 2 * SLOWEST:
        pass
    return panel


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (stuck, "only 1 look different"),
        (endless, "not finite"),
        (wordless, "no description"),
        (moody, "not what render draws"),
        (slow, "to draw"),
    ],
)
def test_the_selftest_catches(fault, message):
    class Faulty(Bars):
        def render(self, **state):
            return fault(super().render(**state), state)

    with pytest.raises(AssertionError, match=message):
        Faulty().selftest()


def test_a_demo_may_say_that_states_can_look_alike(capsys):
    class Alike(Bars):
        distinct = False

        def render(self, **state):
            return stuck(super().render(**state), state)

    Alike().selftest()
    assert capsys.readouterr().out == "3 states, 1 distinct\n"


def test_the_strip_shows_states_without_a_kernel():
    strip = Bars().strip([{"ink": "red"}, {"ink": "blue"}]).data
    assert strip.count("<svg") == 2
    assert "a blue bar of 2" in strip


def test_its_words_name_the_call_that_needs_no_kernel_and_never_change():
    demo = Bars()
    before = repr(demo)
    demo.set(ink="blue")
    assert repr(demo) == before
    assert ".render(height=2, width=1.0, ink='red')" in before


def test_a_demo_without_a_picture_says_so():
    class Empty(Demo):
        controls: ClassVar = {"a": [1, 2]}
        grid: ClassVar = []

    with pytest.raises(NotImplementedError, match="Empty does not say how it looks"):
        Empty()
