from dataclasses import FrozenInstanceError

import numpy as np
import pytest
import torch

from s2glib.body import Motion
from s2glib.data import GESTURE_TYPES, Clip, Interval


def clip(phonemes):
    motion = Motion(torch.zeros(2, 55, 3), torch.zeros(2, 3), torch.zeros(2, 100), 30)
    return Clip(
        id="s00-voice_01-neutral-t0",
        sentence=0,
        speaker="voice_01",
        emotion="neutral",
        take=0,
        intensity=0.5,
        waveform=None,
        motion=motion,
        words=(),
        phonemes=phonemes,
        semantic=np.zeros(2),
        gesture_type=np.zeros(2, dtype=np.int64),
    )


def test_beats_of_speech_are_the_starts_of_primary_stresses():
    sounds = [("m", 0.1), ("ˈiː", 0.2), ("ˌoʊ", 0.4), ("", 0.5), ("ˈaʊ", 0.7)]
    found = clip(tuple(Interval(name, start, start + 0.1) for name, start in sounds))
    assert found.stress_times.tolist() == [0.2, 0.7]


def test_silence_has_no_stress():
    assert clip(()).stress_times.shape == (0,)


def test_a_clip_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        clip(()).emotion = "anger"


def test_rest_is_the_first_gesture_type():
    assert GESTURE_TYPES[0] == "rest"
    assert len(set(GESTURE_TYPES)) == 5
