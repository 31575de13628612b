"""What stays, stays bit for bit; what does not is made anew."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.audio import Waveform
from s2glib.body import Motion
from s2glib.data import load_clip
from s2glib.papers.probtalk import (
    JOINTS_OF,
    PARTS,
    PQVAE,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    TEACHING_REFINER,
    Predictor,
    ProbTalk,
    Refiner,
)
from s2glib.papers.probtalk.editing import (
    carry_on,
    context,
    fill_in,
    keep_parts,
    restyle,
    samples,
)

FRAMES = 60
CALLS = {
    "fill_in": lambda *asked: fill_in(*asked, 20, 30, generator=chance()),
    "carry_on": lambda *asked: carry_on(*asked, generator=chance()),
    "keep_parts": lambda *asked: keep_parts(*asked, ["face"], generator=chance()),
    "restyle": lambda *asked: restyle(*asked, 3, generator=chance()),
}


@pytest.fixture(scope="module")
def probtalk():
    """Small networks that were never trained; what they make is never zero."""
    torch.manual_seed(0)
    pqvae = PQVAE(replace(TEACHING_PQVAE, widths=(8, 8, 8, 8)))
    pqvae.features.fit(0.3 * torch.randn(300, 55, 3), torch.rand(300, 100))
    for parameter in pqvae.decoder.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    thin = {"width": 16, "heads": 2, "layers": 1, "hidden": 16, "style": 8}
    predictor = Predictor(
        replace(TEACHING_PREDICTOR, audio_width=8, context_widths=(8, 8, 8), **thin)
    )
    refiner = Refiner(replace(TEACHING_REFINER, head=16, **thin))
    refiner.features.load_state_dict(pqvae.features.state_dict())
    for parameter in refiner.head.parameters():
        torch.nn.init.normal_(parameter, std=0.05)
    return ProbTalk(pqvae, predictor, refiner)


@pytest.fixture
def speech():
    return Waveform(np.zeros(32000, np.float32), 16000)


@pytest.fixture
def known():
    generator = torch.Generator().manual_seed(9)
    return Motion(
        torch.randn(FRAMES, 55, 3, generator=generator), torch.zeros(FRAMES, 3),
        torch.zeros(FRAMES, 100), 30,
    )  # fmt: skip


def chance():
    return torch.Generator().manual_seed(0)


@given(st.data())
@settings(max_examples=50)
def test_a_context_is_true_for_its_parts_in_its_stretches_only(data):
    start = data.draw(st.integers(0, FRAMES - 1))
    end = data.draw(st.integers(start + 1, FRAMES))
    parts = data.draw(st.lists(st.sampled_from(PARTS), min_size=1, unique=True))
    mask = context(FRAMES, spans=[(start, end)], parts=parts)
    expected = [
        [start <= frame < end and part in parts for part in PARTS] for frame in range(FRAMES)
    ]
    assert mask.tolist() == expected


def test_without_stretches_and_parts_everything_is_kept():
    assert context(FRAMES).all()


@pytest.mark.parametrize("span", [(-1, 3), (5, 5), (9, 4), (50, 61)])
def test_a_stretch_outside_the_speech_is_refused(span):
    with pytest.raises(ValueError, match=f"got {span[0]} to {span[1]}"):
        context(FRAMES, spans=[span])


@pytest.mark.parametrize("parts", [["tail"], ["face", "legs"], []])
def test_parts_that_a_body_does_not_have_are_refused(parts):
    with pytest.raises(ValueError, match="parts are some of face, body, left_hand, right_hand"):
        context(FRAMES, parts=parts)


def same(made, known):
    """Where the parts of a motion are those of another, bit for bit."""
    frames = min(made.frames, known.frames)
    equal = made.poses[:frames] == known.poses[:frames]
    parts = [equal[:, list(JOINTS_OF[part])].all(-1).all(-1) for part in PARTS]
    kept = torch.zeros(made.frames, 4, dtype=torch.bool)
    kept[:frames] = torch.stack(parts, dim=-1)
    return kept


def beginning_of(motion, frames):
    return Motion(motion.poses[:frames], motion.trans[:frames], motion.expression[:frames], 30)


def test_samples_of_one_sentence_differ_in_every_part(probtalk, speech):
    first, second = samples(probtalk, speech, 2, steps=2, generator=chance())
    assert first.frames == second.frames == FRAMES
    assert not same(first, second).any()


def test_samples_are_of_the_speaker_that_is_asked_for(probtalk, speech):
    ours, theirs = (
        next(samples(probtalk, speech, 1, speaker=number, steps=2, generator=chance()))
        for number in (0, 2)
    )
    assert not torch.equal(ours.poses, theirs.poses)


def test_a_gap_is_filled_between_what_stays(probtalk, speech, known):
    made = fill_in(probtalk, speech, known, 20, 30, generator=chance())
    assert torch.equal(same(made, known), context(FRAMES, spans=[(0, 20), (30, FRAMES)]))


def test_a_gap_may_be_in_some_parts_only(probtalk, speech, known):
    made = fill_in(probtalk, speech, known, 20, 30, parts=["body"], generator=chance())
    assert torch.equal(~same(made, known), context(FRAMES, spans=[(20, 30)], parts=["body"]))


def test_a_beginning_stays_and_goes_on(probtalk, speech, known):
    beginning = beginning_of(known, 25)
    made = carry_on(probtalk, speech, beginning, generator=chance())
    assert torch.equal(same(made, beginning), context(FRAMES, spans=[(0, 25)]))
    assert torch.equal(made.trans[:25], beginning.trans)
    assert torch.equal(made.expression[:25], beginning.expression)


def test_kept_parts_stay_and_the_others_do_not(probtalk, speech, known):
    kept = ["left_hand", "face"]
    made = keep_parts(probtalk, speech, known, kept, generator=chance())
    assert torch.equal(same(made, known), context(FRAMES, parts=kept))


def test_parts_are_kept_for_as_long_as_there_is_motion(probtalk, speech, known):
    short = beginning_of(known, 25)
    made = keep_parts(probtalk, speech, short, ["face"], generator=chance())
    assert torch.equal(same(made, short), context(FRAMES, spans=[(0, 25)], parts=["face"]))


def test_another_speakers_body_keeps_the_face(probtalk, speech, known):
    ours, theirs = (
        restyle(probtalk, speech, known, number, generator=chance()) for number in (0, 7)
    )
    assert torch.equal(same(theirs, known), context(FRAMES, parts=["face"]))
    assert not torch.equal(ours.poses, theirs.poses)


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_what_is_no_speech_and_no_motion_is_refused(
    without_type_hook, probtalk, speech, known, call
):
    with pytest.raises(TypeError, match="speech comes as a Waveform, got NoneType"):
        call(probtalk, None, known)
    for nothing in (None, known.poses):
        with pytest.raises(TypeError, match=f"must be a Motion, got {type(nothing).__name__}"):
            call(probtalk, speech, nothing)


def test_every_gap_of_a_shipped_clip_can_be_filled(probtalk):
    clip = load_clip("s01-voice_01-neutral-t2")
    made = fill_in(probtalk, clip.waveform, clip.motion, 30, 60, generator=chance())
    frames = clip.motion.frames
    assert torch.equal(same(made, clip.motion), context(frames, spans=[(0, 30), (60, frames)]))
