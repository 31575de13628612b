import json

import numpy as np
import pytest

from s2glib.recipes.report import Row, figure, over_draws, ratio, share, table, write_rows
from s2glib.recipes.targets import TARGETS, Bounds, Target

KEYS = ["name", "value", "n", "interval", "aim", "met", "floor", "recorded"]


@pytest.fixture
def aims(monkeypatch):
    """Three kinds of target, under names of their own."""
    monkeypatch.setitem(TARGETS, "high", Target(Bounds(low=0.9), Bounds(low=0.5)))
    monkeypatch.setitem(TARGETS, "close", Target(Bounds(0.95, 1.05)))
    monkeypatch.setitem(TARGETS, "floored", Target(None, Bounds(low=1.5)))


@pytest.mark.parametrize(
    ("bounds", "text"),
    [
        (Bounds(low=0.97), ">= 0.97"),
        (Bounds(high=1.015), "<= 1.015"),
        (Bounds(0.95, 1.05), "0.95 .. 1.05"),
    ],
)
def test_bounds_read_as_one_would_write_them(bounds, text):
    assert str(bounds) == text


def test_a_share_is_the_mean_of_what_came_out_right_inside_its_interval():
    row = share("x", np.array([True] * 30 + [False] * 10))
    assert (row.value, row.n) == (0.75, 40)
    assert row.interval[0] < 0.75 < row.interval[1]


def test_a_ratio_of_equal_values_is_one_without_doubt():
    values = np.random.default_rng(0).random(20) + 1
    assert ratio("x", 2 * values, values) == Row("x", 2.0, 20, (2.0, 2.0))


def test_a_figure_takes_any_statistic_of_several_arrays():
    ours, theirs = np.arange(50.0), np.arange(50.0) + 3
    row = figure("x", ours, theirs, statistic=lambda a, b: float((b - a).max()))
    assert row == Row("x", 3.0, 50, (3.0, 3.0))


def test_a_figure_over_draws_spans_them():
    assert over_draws("x", np.array([1.0, 2.0, 6.0]), 512) == Row("x", 3.0, 512, (1.0, 6.0))


@pytest.mark.parametrize(
    ("name", "value", "met", "held"),
    [
        ("high", 0.95, True, True),
        ("high", 0.7, False, True),
        ("high", 0.4, False, False),
        ("close", 1.06, False, None),
        ("floored", 1.6, None, True),
        ("free", -7.0, None, None),
    ],
)
@pytest.mark.usefixtures("aims")
def test_a_row_knows_whether_its_aim_is_met_and_its_floor_holds(name, value, met, held):
    row = Row(name, value, 3)
    assert (row.met, row.held) == (met, held)


@pytest.mark.usefixtures("aims")
def test_the_json_file_is_a_list_of_rows_with_the_agreed_keys(tmp_path):
    path = tmp_path / "new folder" / "rows.json"
    write_rows(path, [Row("high", 0.7, 3, (0.6, 0.8)), Row("free", 1.0, 2, recorded=True)])
    first, second = json.loads(path.read_text())
    assert list(first) == KEYS
    assert first["aim"] == ">= 0.9"
    assert (first["met"], first["floor"], first["interval"]) == (False, ">= 0.5", [0.6, 0.8])
    assert (second["aim"], second["met"], second["interval"]) == (None, None, None)
    assert second["recorded"] is True
    assert [p.name for p in path.parent.iterdir()] == ["rows.json"]


def test_a_value_that_json_cannot_hold_leaves_no_file(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_rows(tmp_path / "rows.json", [Row("x", float("nan"), 3)])
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("aims")
def test_the_table_has_a_line_for_every_row_and_a_verdict_where_there_is_an_aim():
    rows = [
        *(Row("high", 0.95, 3, (0.9, 1.0)), Row("high", 0.7, 3), Row("high", 0.4, 3)),
        *(Row("free", 0.4, 3), Row("free", 0.4, 3, recorded=True)),
    ]
    head, *lines = table(rows).splitlines()
    assert "aim" in head
    assert [line.rpartition("  ")[2] for line in lines[:3]] == [
        "met",
        "aim missed",
        "below the floor",
    ]
    assert "0.900 .. 1.000" in lines[0]
    assert lines[4].endswith("(recorded)")


def test_no_floor_asks_for_more_than_its_aim():
    both = [t for t in TARGETS.values() if t.aim is not None and t.floor is not None]
    assert len(both) > 10
    assert all(t.floor.low <= t.aim.low and t.floor.high >= t.aim.high for t in both)
