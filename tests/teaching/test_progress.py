import json
import sys

import pytest

import s2glib.teaching.overview
from s2glib.teaching import progress, setup
from s2glib.teaching.progress import record, recorded

STORE = sys.modules["s2glib.teaching.progress"]  # the package's `progress` is the function


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(STORE, "_unwritten", {})
    return tmp_path / "home"


@pytest.fixture
def shown(monkeypatch):
    displayed = []
    monkeypatch.setattr(
        s2glib.teaching.overview, "display", lambda data, raw: displayed.append(data)
    )
    return displayed


def test_what_is_recorded_is_counted_and_read_back_from_one_file(home):
    for state in ("tried", "tried", "solved"):
        record("exercise", "01-2", state)
    record("question", "01-p1", "right")
    assert recorded() == {
        "exercise": {"01-2": {"tried": 2, "solved": 1}},
        "question": {"01-p1": {"right": 1}},
    }
    assert [path.name for path in home.iterdir()] == ["progress.json"]


def test_two_sessions_do_not_undo_each_other(home):
    record("exercise", "01-1", "solved")
    file = home / "progress.json"
    theirs = json.loads(file.read_text())
    theirs["exercise"]["02-1"] = {"solved": 1}
    file.write_text(json.dumps(theirs))
    record("exercise", "01-2", "solved")
    assert set(recorded()["exercise"]) == {"01-1", "01-2", "02-1"}


@pytest.mark.parametrize(
    "text",
    ["{", "[]", "3", '{"exercise": 1}', '{"a": {"b": {"c": "d"}}}', "[" * 100_000, "\x00", ""],
)
def test_a_file_that_is_no_progress_is_set_aside(home, text):
    home.mkdir()
    (home / "progress.json").write_text(text)
    record("exercise", "01-1", "solved")
    assert recorded() == {"exercise": {"01-1": {"solved": 1}}}
    assert (home / "progress.bak").read_text() == text


def test_without_a_place_to_write_progress_lasts_as_long_as_the_session(home, capsys):
    home.write_text("a file where the folder should be")
    record("exercise", "01-1", "tried")
    record("exercise", "01-1", "solved")
    assert recorded() == {"exercise": {"01-1": {"tried": 1, "solved": 1}}}
    assert capsys.readouterr() == ("", "")
    assert home.read_text() == "a file where the folder should be"


def test_whoever_has_no_home_can_read_on(home, monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(STORE, "home_folder", homeless)
    record("notebook", "01", "opened")
    assert recorded() == {"notebook": {"01": {"opened": 1}}}


def test_another_kind_is_refused(home):
    with pytest.raises(ValueError, match="exercise, notebook, question; got 'lesson'"):
        record("lesson", "01", "opened")


def test_setup_notes_that_a_notebook_was_opened(home):
    setup("01")
    assert recorded() == {"notebook": {"01": {"opened": 1}}}


def test_the_table_counts_what_is_done_of_what_there_is(home, shown, monkeypatch, tmp_path):
    for name in ("00_start_here", "01_motion_and_sound", "99_later"):
        (tmp_path / f"{name}.ipynb").touch()
    monkeypatch.setattr(s2glib.teaching.overview, "NOTEBOOKS", tmp_path)
    record("notebook", "01", "opened")
    record("exercise", "01-1", "solved")
    record("exercise", "01-2", "tried")
    record("exercise", "77-1", "solved")
    progress()
    (only,) = shown
    header, start, motion, later = only["text/plain"].splitlines()
    assert header.split("  ")[0] == "notebook"
    assert start.startswith("00 Start here")
    assert motion.startswith("01 Motion and sound  yes     1 of 3            0 of ")
    assert later == "99 Later"
    assert "| 01 Motion and sound | yes | 1 of 3 | 0 of " in only["text/markdown"]
