from types import SimpleNamespace

import pytest
import torch
from stand_in import tone, waving_motion

from s2glib.corpus import EMOTIONS, SENTENCES
from s2glib.papers.amuse import Amuse, Heard, SpeechLatents
from s2glib.widgets import corpus_swap

NAMES = [
    f"s{sentence:02d}-{speaker}-{emotion}-t2"
    for sentence in (4, 1)
    for speaker in ("voice_03", "voice_01")
    for emotion in EMOTIONS
]


class Pretended(Amuse):
    """Gestures that wave as far as the first emotion number says; counts what it is asked."""

    def __init__(self):
        self.asked = []

    def hear(self, waveform):
        latents = SpeechLatents(torch.zeros(1, 4), torch.ones(1, 2), torch.zeros(1, 2))
        return Heard(latents, torch.zeros(1, 3, 4), torch.zeros(5, 6), 20)

    def emotion_centre(self, number):
        return torch.full((2,), 2.0 + number)

    def gesture(self, heard, *, generator):
        reach = heard.latents.emotion[0, 0].item()
        self.asked.append((reach, torch.rand((), generator=generator).item()))
        return waving_motion(20, reach=reach)


@pytest.fixture
def amuse(monkeypatch):
    def load(name):
        assert name in NAMES
        return SimpleNamespace(waveform=tone(1), motion=waving_motion(30, reach=-1.0))

    monkeypatch.setattr("s2glib.widgets.shipped_swap.clips", lambda: NAMES)
    monkeypatch.setattr("s2glib.widgets.shipped_swap.load_clip", load)
    return Pretended()


@pytest.fixture
def demo(amuse, body):
    return corpus_swap(amuse, body)


def test_it_offers_what_is_shipped(demo):
    assert demo.sentence.options == tuple((SENTENCES[number].text, number) for number in (1, 4))
    assert demo.speaker.options == ("voice_01", "voice_03")
    assert demo.emotion.options == EMOTIONS


def test_source_and_edit_start_from_the_same_noise(demo, amuse):
    (own, noise), (swapped, same) = sorted(amuse.asked)
    assert (own, swapped) == (1.0, 2.0 + EMOTIONS.index(demo.new_emotion.value))
    assert noise == same


def test_what_was_computed_is_kept(demo, amuse):
    demo.new_emotion.value = "anger"
    amuse.asked.clear()
    for emotion in ("disgust", "anger"):
        demo.new_emotion.value = emotion
    assert amuse.asked == []


def test_a_burst_of_choices_ends_with_the_last_one(demo, amuse, body):
    for emotion in (*EMOTIONS, "sadness"):
        demo.new_emotion.value = emotion
    demo.shown.value = "edited"
    assert demo.player.view == "edited"
    assert "sadness" in demo.told.value
    assert demo._motions["edited"].poses.equal(
        waving_motion(20, reach=2.0 + EMOTIONS.index("sadness")).poses
    )
