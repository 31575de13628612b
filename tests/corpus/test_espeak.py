import subprocess
from pathlib import Path

import espeakng_loader
import numpy as np
import pytest

from s2glib.corpus import VOICES, espeak


@pytest.fixture(scope="module")
def utterance():
    return espeak.synthesize("red boats now", "f4")


def test_every_voice_of_the_script_gives_the_same_samples_a_second_later():
    def speak_all():
        return [espeak.synthesize("red boats", voice.variant).samples for voice in VOICES.values()]

    first = speak_all()  # takes longer than the second that a clock-seeded variant would need
    again = speak_all()
    assert [np.array_equal(a, b) for a, b in zip(first, again, strict=True)] == [True] * len(VOICES)


def test_words_and_phonemes_come_with_rising_times_inside_the_sound(utterance):
    assert [word for word, _ in utterance.words] == ["red", "boats", "now"]
    for events in (utterance.words, utterance.phonemes):
        times = [start for _, start in events]
        assert times == sorted(times)
        assert times[-1] < utterance.duration
    assert any("ˈ" in phoneme for phoneme, _ in utterance.phonemes)


def test_the_sound_is_speech_and_not_clipped(utterance):
    assert 0.5 < utterance.duration < 3
    assert 0.1 < np.abs(utterance.samples).max() <= 1


def test_every_voice_of_the_script_exists():
    data = Path(espeakng_loader.get_data_path(), "voices", "!v")
    assert {voice.variant for voice in VOICES.values()} <= {path.name for path in data.iterdir()}


def test_an_unknown_voice_is_refused_by_name():
    with pytest.raises(ValueError, match="variant 'nobody'"):
        espeak.synthesize("red", "nobody")


def test_without_the_extra_the_message_says_what_to_install(monkeypatch):
    stderr = b"ModuleNotFoundError: No module named 'espeakng_loader'\n"
    failed = subprocess.CompletedProcess([], 1, b"", stderr)
    monkeypatch.setattr(espeak.subprocess, "run", lambda *_, **__: failed)
    with pytest.raises(ImportError, match=r"s2glib\[corpus\]"):
        espeak.synthesize("red", "f4")
