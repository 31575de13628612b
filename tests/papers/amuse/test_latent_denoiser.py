from dataclasses import replace

import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import (
    PAPER_DENOISER,
    TEACHING_DENOISER,
    LatentDenoiser,
    SpeechCondition,
    SpeechLatents,
)


@pytest.fixture
def xt():
    return torch.randn(3, 5, 6)


@pytest.fixture(params=["adaptive", "tokens"])
def any_denoiser(request, denoiser_config, awake):
    config = replace(denoiser_config, backbone=request.param)
    return awake(LatentDenoiser(config))


def with_emotion(condition, emotion):
    return condition._replace(latents=condition.latents._replace(emotion=emotion))


def test_an_emotion_that_was_dropped_has_no_say(any_denoiser, condition, xt):
    other = with_emotion(condition, torch.randn(3, 6))
    without = (c.without_emotion() for c in (condition, other))
    first, second = (any_denoiser(xt, 500, c) for c in without)
    assert torch.equal(first, second)
    assert (any_denoiser(xt, 500, condition) - any_denoiser(xt, 500, other)).abs().max() > 1e-3


@pytest.mark.parametrize("place", [0, 1, 2])
def test_each_latent_has_a_say_until_it_is_dropped(any_denoiser, condition, xt, place):
    moved = SpeechLatents(*(x + (n == place) for n, x in enumerate(condition.latents)))
    other = condition._replace(latents=moved)
    dropped = condition.dropped.clone()
    dropped[:, place] = True
    said = [any_denoiser(xt, 3, c) for c in (condition, other)]
    silent = [any_denoiser(xt, 3, c._replace(dropped=dropped)) for c in (condition, other)]
    assert (said[0] - said[1]).abs().max() > 1e-5
    assert torch.equal(*silent)


def test_without_emotion_keeps_the_other_two_and_the_original(condition):
    condition.dropped[0, 0] = True
    without = condition.without_emotion()
    assert without.dropped.tolist() == [
        [True, True, False],
        [False, True, False],
        [False, True, False],
    ]
    assert not condition.dropped[:, 1].any()


def test_a_level_may_be_a_number_or_one_per_clip(any_denoiser, condition, xt):
    same = any_denoiser(xt, torch.tensor([7, 7, 7]), condition)
    torch.testing.assert_close(any_denoiser(xt, 7, condition), same)
    assert (any_denoiser(xt, 900, condition) - same).abs().max() > 1e-3


def test_clips_of_a_batch_do_not_mix(any_denoiser, condition, xt):
    alone = SpeechCondition(
        SpeechLatents(*(x[1:2] for x in condition.latents)),
        condition.tracks[1:2],
        condition.dropped[1:2],
    )
    whole = any_denoiser(xt, 10, condition)
    torch.testing.assert_close(any_denoiser(xt[1:2], 10, alone), whole[1:2], rtol=1e-4, atol=1e-4)


def test_tracks_belong_to_the_tokens_of_their_frames(denoiser, condition):
    """Before any layer mixes tokens, a change in frame 25 reaches local token 2 alone."""
    tracks = condition.tracks.clone()
    tracks[:, 25] += 1
    h = torch.zeros(3, 5, 16)
    before, after = (
        denoiser._with_tracks(h, condition._replace(tracks=t)) for t in (condition.tracks, tracks)
    )
    changed = (before - after).abs().amax(dim=(0, 2)) > 1e-6
    assert changed.nonzero().flatten().tolist() == [1 + 2]  # after the global token


def test_standardised_latents_come_back(denoiser):
    denoiser.latent_mean.normal_()
    denoiser.latent_std.uniform_(0.5, 2)
    latents = torch.randn(2, 5, 6)
    torch.testing.assert_close(denoiser.restore(denoiser.standardize(latents)), latents)


def test_an_untrained_adaptive_denoiser_predicts_the_mean(denoiser_config, condition, xt):
    assert (LatentDenoiser(denoiser_config)(xt, 5, condition) == 0).all()


@pytest.mark.parametrize("config", [PAPER_DENOISER, TEACHING_DENOISER], ids=["paper", "teaching"])
def test_both_presets_denoise_latents_of_their_prior(config):
    frames = config.frames_per_token * (config.tokens - config.global_tokens)
    with torch.device("meta"):
        denoiser = LatentDenoiser(config)
        sizes = (config.content_dim, config.emotion_dim, config.style_dim)
        latents = SpeechLatents(*(torch.zeros(2, size) for size in sizes))
        tracks = torch.zeros(2, frames, config.track_features)
        condition = SpeechCondition(latents, tracks, torch.zeros(2, 3, dtype=torch.bool))
        xt = torch.zeros(2, config.tokens, config.token_dim)
        assert denoiser(xt, 999, condition).shape == xt.shape


def test_the_paper_denoiser_has_nine_layers_with_four_skips():
    with torch.device("meta"):
        denoiser = LatentDenoiser(PAPER_DENOISER)

    def linear(n, m):
        return n * m + m

    layer = 4 * linear(128, 128) + linear(128, 512) + linear(512, 128) + 4 * 128
    expected = 9 * layer + 4 * linear(256, 128)
    expected += linear(128, 128) + 3 * linear(256, 128) + 3 * 128  # latent, conditions, stand-ins
    expected += linear(256, 128) + linear(128, 128) + 5 * 128  # time; z, t, c, e, s have places
    expected += 2 * 128 + linear(128, 128)
    assert sum(p.numel() for p in denoiser.parameters()) == expected


def test_a_checkpoint_brings_back_the_denoiser_with_its_statistics(
    denoiser, condition, xt, tmp_path
):
    denoiser.latent_mean.normal_()
    path = tmp_path / "denoiser.safetensors"
    save_checkpoint(path, denoiser, denoiser.config)
    loaded = load_checkpoint(path, LatentDenoiser)
    assert torch.equal(loaded(xt, 3, condition), denoiser(xt, 3, condition))
    assert torch.equal(loaded.latent_mean, denoiser.latent_mean)
