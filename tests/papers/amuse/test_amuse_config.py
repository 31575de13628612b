import subprocess
import sys
from dataclasses import FrozenInstanceError

import pytest
import torch

from s2glib.papers.amuse import (
    PAPER_DENOISER,
    PAPER_EXTRACTOR,
    PAPER_PRIOR,
    PAPER_SPEECH,
    TEACHING_DENOISER,
    TEACHING_EXTRACTOR,
    TEACHING_PRIOR,
    TEACHING_SPEECH,
    LatentDenoiser,
    MotionExtractor,
    MotionPrior,
    SpeechCondition,
    SpeechLatents,
)


@pytest.mark.parametrize(
    ("speech", "prior", "denoiser"),
    [
        (PAPER_SPEECH, PAPER_PRIOR, PAPER_DENOISER),
        (TEACHING_SPEECH, TEACHING_PRIOR, TEACHING_DENOISER),
    ],
    ids=["paper", "teaching"],
)
def test_the_parts_of_a_preset_fit_together(speech, prior, denoiser):
    for name in ("content_dim", "emotion_dim", "style_dim"):
        assert getattr(denoiser, name) == getattr(speech, name)
    assert (denoiser.tokens, denoiser.token_dim) == (prior.tokens, prior.token_dim)


@pytest.mark.parametrize(
    ("prior", "denoiser", "extractor", "frames", "features"),
    [
        (PAPER_PRIOR, PAPER_DENOISER, PAPER_EXTRACTOR, 300, 333),
        (TEACHING_PRIOR, TEACHING_DENOISER, TEACHING_EXTRACTOR, 120, 90),
    ],
    ids=["paper", "teaching"],
)
def test_poses_pass_through_prior_denoiser_and_extractor(
    prior, denoiser, extractor, frames, features
):
    with torch.device("meta"):
        prior, delta, judge = (
            MotionPrior(prior),
            LatentDenoiser(denoiser),
            MotionExtractor(extractor),
        )
        latents = SpeechLatents(*(torch.zeros(2, n.in_features) for n in delta.conditions))
        tracks = torch.zeros(2, frames, denoiser.track_features)
        condition = SpeechCondition(latents, tracks, torch.zeros(2, 3, dtype=torch.bool))
        motion = prior.features.from_poses(torch.zeros(2, frames, 55, 3))
        x0 = delta(delta.standardize(prior.encode(motion).mean), 999, condition)
        drawn = prior.decode(delta.restore(x0))
        assert motion.shape == drawn.shape == (2, frames, features)
        assert judge(judge.features.valid(drawn)).logits.shape == (2, 8)
        assert prior.features.to_poses(drawn).shape == (2, frames, 55, 3)


def test_time_tracks_of_the_teaching_preset_fill_its_local_tokens():
    speech, prior, denoiser = TEACHING_SPEECH, TEACHING_PRIOR, TEACHING_DENOISER
    assert denoiser.track_features == 3 + speech.content_dim // speech.content_tokens
    local_tokens = denoiser.tokens - denoiser.global_tokens
    assert local_tokens * denoiser.frames_per_token == prior.frames == TEACHING_EXTRACTOR.frames
    assert speech.frames * speech.pool / 100 > prior.frames / 30  # a motion window hears itself


def test_the_paper_preset_prints_the_papers_sizes():
    assert (PAPER_SPEECH.n_mels, PAPER_SPEECH.frames) == (128, 1024)  # [AM B.5]
    assert (PAPER_SPEECH.width, PAPER_SPEECH.layers, PAPER_SPEECH.heads) == (768, 12, 12)
    assert (PAPER_SPEECH.emotions, PAPER_SPEECH.styles) == (8, 30)


def test_a_preset_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        PAPER_SPEECH.width = 1


def test_importing_the_room_leaves_slow_libraries_alone():
    slow = "('librosa', 'trimesh', 'transformers', 'matplotlib')"
    code = f"import sys, s2glib.papers.amuse; print([m for m in {slow} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
