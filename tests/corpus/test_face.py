import numpy as np
import pytest

from s2glib.body import FACE_CURVES, joint
from s2glib.corpus import render_motion
from s2glib.corpus.clock import Timing, readings
from s2glib.corpus.face import EXPRESSIONS, WIDEST_JAW, face_tracks, mouth_shapes, viseme
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell

PHONEMES = sorted({phoneme for reading in readings() for phoneme in reading.phonemes})
FACE = np.arange(300) / 30


def slow_speech(*phonemes):
    """Half a second of each phoneme, from the start of the clip."""
    bounds = 0.5 * np.arange(len(phonemes) + 1)
    nothing = np.zeros(len(phonemes), dtype=bool)
    return Timing(phonemes, bounds, nothing, (), np.zeros(0), np.zeros(0))


def track(emotion, intensity, seed=0):
    return face_tracks(slow_speech("m"), FACE, emotion, intensity, np.random.default_rng(seed))


@pytest.mark.parametrize("phoneme", PHONEMES)
def test_every_phoneme_of_the_script_has_a_mouth_shape(phoneme):
    shape = viseme(phoneme)
    assert len(shape) == 4
    assert 0 <= min(shape) <= max(shape) <= 1
    assert (max(shape) == 0) == (phoneme == "")


@pytest.mark.parametrize("sign", ["ˈ", "ˌ"])
def test_stress_does_not_change_a_mouth_shape(sign):
    assert viseme(f"{sign}ɑː") == viseme("ɑ")


@pytest.mark.parametrize("closed", "mbp")
def test_the_jaw_opens_on_vowels_and_lips_close_on_m_b_and_p(closed):
    clock = slow_speech(closed, "ˈɑː", closed, "uː", "iː", "")
    jaw, rounded, wide, press = mouth_shapes(clock, np.arange(90) / 30)[7::15].T  # middles
    assert jaw == pytest.approx([0, 0.9, 0, 0.25, 0.3, 0])
    assert press == pytest.approx([1, 0, 1, 0, 0, 0])
    assert rounded.argmax() == 3
    assert wide.argmax() == 4


def test_in_real_speech_jaws_open_on_vowels_and_not_on_closed_lips():
    opening = {"open": [], "closed": []}
    for sentence in range(16):
        clip = render_motion(Cell(sentence, "voice_01", "sadness", 2))
        jaw = clip.motion.poses[:, joint("jaw"), 0].numpy()
        for phoneme in clip.phonemes:
            middle = jaw[round(15 * (phoneme.start + phoneme.end))]
            sound = phoneme.name.strip("ˈˌː")[:1]
            kind = "open" if sound in tuple("aɑæʌ") else "closed" if sound in tuple("mbp") else ""
            opening.get(kind, []).append(middle)
    assert np.mean(opening["open"]) > 2 * np.mean(opening["closed"])
    assert np.mean(opening["open"]) > 0.5 * WIDEST_JAW


def test_before_and_after_the_words_the_mouth_is_shut():
    clip = render_motion(Cell(3, "voice_02", "happiness", 1))
    jaw = clip.motion.poses[:, joint("jaw"), 0].numpy()
    assert jaw[[0, 5, -1]] == pytest.approx(0.02)
    assert jaw.max() <= 0.02 + WIDEST_JAW + 1e-6


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_a_face_shows_its_emotion_as_strongly_as_the_clip_does(emotion):
    weak, strong = (track(emotion, strength)[1].mean(axis=0) for strength in (0.2, 0.9))
    for name, value in EXPRESSIONS[emotion].items():
        if name not in ("lid_close", "lip_press"):  # blinks and the m are there as well
            assert strong[FACE_CURVES.index(name)] == pytest.approx(0.9 * value, rel=0.3)
            assert strong[FACE_CURVES.index(name)] > weak[FACE_CURVES.index(name)]


def test_a_neutral_face_only_speaks_and_blinks():
    _, curves = track("neutral", 1.0)
    busy = {FACE_CURVES[c] for c in np.flatnonzero(curves.max(axis=0) > 0)}
    assert busy <= {"lid_close", "lip_round", "lip_wide", "lip_press"}


@pytest.mark.parametrize("seed", range(5))
def test_eyes_blink_now_and_then(seed):
    lids = track("neutral", 1.0, seed)[1][:, FACE_CURVES.index("lid_close")]
    closed = np.flatnonzero((lids[1:] > 0.5) & (lids[:-1] <= 0.5))
    assert 2 <= len(closed) <= 6  # in ten seconds
    assert (lids > 0.5).mean() < 0.15


def test_all_curves_stay_between_0_and_1():
    for emotion in EMOTIONS:
        for speaker in SPEAKERS[:2]:
            curves = render_motion(Cell(4, speaker, emotion, 0)).motion.expression
            assert 0 <= curves.min() <= curves.max() <= 1
