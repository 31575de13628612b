import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from s2glib.widgets import ToyArm

ANGLES = st.integers(-12, 12).map(lambda step: 15 * step)


@given(shoulder=ANGLES, elbow=ANGLES)
def test_the_hand_is_where_trigonometry_puts_it(shoulder, elbow):
    facts = ToyArm.render(None, shoulder, elbow).facts
    a, b = math.radians(shoulder), math.radians(shoulder + elbow)
    assert facts["x"] == pytest.approx(0.3 * math.cos(a) + 0.25 * math.cos(b), abs=0.006)
    assert facts["y"] == pytest.approx(0.3 * math.sin(a) + 0.25 * math.sin(b), abs=0.006)


def test_it_tests_itself(capsys):
    ToyArm().selftest()
    assert capsys.readouterr().out == "5 states, 5 distinct\n"


def test_a_zero_is_said_without_a_sign():
    assert "x = 0.00 m, y = 0.55 m" in ToyArm().render(90, 0).alt
    assert "x = -0.55 m, y = 0.00 m" in ToyArm().render(-180, 0).alt
