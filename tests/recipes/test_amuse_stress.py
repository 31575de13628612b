import pytest

from s2glib.corpus.build import timing_of
from s2glib.corpus.script import Cell
from s2glib.papers.amuse.config import PAPER_SPEECH, TEACHING_SPEECH
from s2glib.papers.amuse.stress_listener import StressConfig, StressListener
from s2glib.recipes.amuse_stress import stress_correlation, true_stresses


@pytest.mark.parametrize(("config", "rate"), [(TEACHING_SPEECH, 50), (PAPER_SPEECH, 100)])
def test_true_stresses_stand_where_the_clock_has_them(config, rate):
    cells = [Cell(4, "voice_01", "anger", 0), Cell(0, "voice_05", "fear", 1)]
    for cell, track in zip(cells, true_stresses(cells, config), strict=True):
        for stress in timing_of(cell).stress_times:
            assert track[int(stress * rate)] > 0.9


def test_a_listener_that_hears_the_truth_correlates_perfectly(monkeypatch):
    targets = true_stresses([Cell(4, "voice_01", "anger", 0)], TEACHING_SPEECH)
    listener = StressListener(StressConfig())
    monkeypatch.setattr(listener, "forward", lambda speech: speech[..., 0])
    heard = targets[..., None].expand(-1, -1, 64)
    assert stress_correlation(listener, heard, targets) == pytest.approx(1.0)
