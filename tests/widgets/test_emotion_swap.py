from types import SimpleNamespace

import pytest
from stand_in import tone, waving_motion

from s2glib.widgets import EmotionSwapDemo, Player

EMOTIONS = ("neutral", "anger", "sadness")


@pytest.fixture
def calls():
    return []


@pytest.fixture
def demo(body, calls):
    def generate(clip):
        calls.append(("generate", clip))
        return waving_motion(20)

    def edit(clip, emotion):
        calls.append(("edit", clip, emotion))
        return waving_motion(20, reach=1 + EMOTIONS.index(emotion))

    def load(clip):
        pitch = 200 + 50 * EMOTIONS.index(clip.split("-")[2])
        return SimpleNamespace(waveform=tone(1, pitch=pitch), motion=waving_motion(30, reach=3.0))

    return EmotionSwapDemo(
        body,
        [("the meeting starts", 0), ("you can put", 1)],
        ["voice_01", "voice_02"],
        EMOTIONS,
        find="{}-{}-{}".format,
        load=load,
        generate=generate,
        edit=edit,
    )


def plays(demo, body, motion, waveform):
    expected = Player(motion, waveform, body)
    return (demo.player.motion, demo.player.sound) == (expected.motion, expected.sound)


def test_it_opens_on_both_bodies_and_the_sound_of_the_source(demo, body):
    pair = {"source": waving_motion(20), "edited": waving_motion(20, reach=3.0)}
    assert plays(demo, body, pair, tone(1, pitch=200))
    assert demo.player.view == ""


def test_another_emotion_is_generated_once_for_the_same_source(demo, calls):
    calls.clear()
    demo.new_emotion.value = "anger"
    assert calls == [("edit", "0-voice_01-neutral", "anger"), ("generate", "0-voice_01-neutral")]


def test_looking_at_one_body_computes_nothing(demo, calls):
    calls.clear()
    demo.shown.value = "edited"
    assert demo.player.view == "edited"
    assert calls == []


def test_the_true_target_brings_its_own_sound(demo, body):
    demo.shown.value = "true target"
    target = {"true target": waving_motion(30, reach=3.0)}
    assert plays(demo, body, target, tone(1, pitch=300))


def test_the_words_below_name_both_emotions(demo):
    demo.emotion.value = "anger"
    assert "<b>anger</b> and <b>sadness</b>" in demo.told.value
    assert 'role="status"' in demo.told.value


def test_an_error_of_the_model_reaches_the_reader(demo):
    def broken(clip, emotion):
        raise RuntimeError("no checkpoint")

    demo._edit = broken
    with pytest.raises(RuntimeError, match="no checkpoint"):
        demo.new_emotion.value = "neutral"


def test_its_words_never_change(demo):
    before = repr(demo)
    demo.speaker.value = "voice_02"
    assert repr(demo) == before
