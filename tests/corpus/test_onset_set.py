import numpy as np

from s2glib.audio import onset_times
from s2glib.corpus import build
from s2glib.corpus.script import Cell


def test_cached_onsets_are_those_of_the_rendered_sound(monkeypatch, tmp_path):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    request = build.Request(Cell(1, "voice_01", "anger", 2), "neutral")
    (first,) = build.onset_set([request], processes=1)
    monkeypatch.delattr(build, "_render_all")  # from here on there is only the cache
    (second,) = build.onset_set([request])
    sound = build.render_clip(*request.cell, clock_of="neutral").waveform
    assert np.array_equal(first, onset_times(sound.samples, sound.sample_rate))
    assert np.array_equal(first, second)
