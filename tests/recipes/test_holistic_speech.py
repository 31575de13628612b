"""What is heard in training: log-mels, or the public wav2vec2 where a reader has put it."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from s2glib.audio import Waveform
from s2glib.corpus import Cell
from s2glib.corpus.build import SpeechSet
from s2glib.papers.probtalk import at_motion_rate
from s2glib.recipes import holistic_speech as module

CELL = Cell(0, "voice_01", "anger", 0)


@pytest.fixture(autouse=True)
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    return tmp_path


def test_log_mels_out_of_the_cache_come_at_the_motions_rate(monkeypatch, rng):
    window = rng.normal(size=(1, 352, 64)).astype(np.float16)
    monkeypatch.setattr(module, "speech_set", lambda requests: SpeechSet(window, np.ones(1)))
    heard = module.hearing("paper")  # nobody has put wav2vec2 there
    (track,) = heard.tracks([CELL])
    assert heard == module.hearing("teaching")
    assert track.shape == (211, heard.channels)
    torch.testing.assert_close(track, at_motion_rate(torch.from_numpy(window).float())[0])


def test_the_paper_hears_wav2vec2_where_it_is_in_the_cache(empty_cache, monkeypatch):
    (empty_cache / module.WAV2VEC2).mkdir(parents=True)
    sound = SimpleNamespace(waveform=Waveform(np.zeros(16_001, np.float32), 16_000))

    def wav2vec2(folder):
        assert folder == empty_cache / module.WAV2VEC2
        return lambda samples, frames: torch.full((frames, 5), float(len(samples)))

    monkeypatch.setattr(module, "wav2vec2", wav2vec2)
    monkeypatch.setattr(module, "render_clip", lambda *cell: sound)
    heard = module.hearing("paper")
    (track,) = heard.tracks([CELL])
    assert heard.channels == 5
    assert track.shape == (30, 5)
    assert (track == 16_001).all()
    assert module.hearing("teaching").tracks is module.log_mel_tracks
