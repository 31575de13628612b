import numpy as np
import pytest
import torch

from s2glib.papers.amuse import MotionPrior, start_from_components
from s2glib.papers.amuse.temporal_prior import principal_components


def project(rows, count):
    """Plain PCA by numpy: rows on their first principal components."""
    mean = rows.mean(axis=0)
    _, _, directions = np.linalg.svd(rows - mean, full_matrices=False)
    return mean + (rows - mean) @ directions[:count].T @ directions[:count]


@pytest.fixture
def clips():
    """Smooth motion: every feature a slow wave around a clip's own posture."""
    t = torch.linspace(0, 6, 40)[:, None]
    posture, phase = torch.randn(60, 1, 90), 6 * torch.rand(60, 1, 90)
    return posture + torch.sin(t + phase)


@pytest.fixture
def started(prior_config, clips):
    prior = MotionPrior(prior_config).eval()
    start_from_components(prior.encoder, prior.decoder, clips)
    return prior


def test_components_are_uncorrelated_with_unit_variance():
    rows = torch.randn(500, 8) @ torch.randn(8, 8) + 3
    mean, basis = principal_components(rows, 4)
    scores = (rows - mean) @ torch.linalg.pinv(basis).T
    torch.testing.assert_close(scores.T @ scores / 500, torch.eye(4), atol=1e-3, rtol=0)
    torch.testing.assert_close(mean, rows.mean(0))


def test_components_are_those_of_the_singular_value_decomposition():
    rows = torch.randn(200, 8) @ torch.randn(8, 8)
    mean, basis = principal_components(rows, 3)
    scores = (rows - mean) @ torch.linalg.pinv(basis).T
    expected = project(rows.numpy().astype(np.float64), 3)
    torch.testing.assert_close(
        (mean + scores @ basis.T).double(), torch.from_numpy(expected), atol=1e-3, rtol=0
    )


def test_training_starts_as_pca_of_postures_and_of_patches(started, clips):
    motion = clips.numpy().astype(np.float64)
    postures = project(motion.mean(axis=1), 6)
    rest = motion - postures[:, None]
    patches = project(rest.reshape(60 * 4, 10 * 90), 6).reshape(60, 40, 90)
    with torch.no_grad():
        ours = started(clips).double().numpy()
    assert ours == pytest.approx(postures[:, None] + patches, abs=2e-2)


def test_the_start_reconstructs_better_than_nothing(started, clips):
    with torch.no_grad():
        error = (started(clips) - clips).square().mean()
    assert error < 0.8 * (clips - clips.mean(dim=(0, 1))).square().mean()


def test_latents_of_the_start_are_standard(started, clips):
    with torch.no_grad():
        whole = started.encode(clips).mean[:, 0]
    torch.testing.assert_close(whole.T @ whole / 60, torch.eye(6), atol=1e-2, rtol=0)


def test_the_encoder_starts_sure_of_itself(started, clips):
    assert (started.encode(clips).log_var == -4).all()


def test_a_local_token_moves_its_own_ten_frames_at_first(started):
    tokens = torch.zeros(1, 5, 6)
    other = tokens.clone()
    other[:, 2] = 1.0  # the second local token
    moved = (started.decode(other) - started.decode(tokens)).abs().amax(dim=(0, 2)) > 1e-6
    assert moved.nonzero().flatten().tolist() == list(range(10, 20))


def test_encoder_and_decoder_share_the_posture_map(prior_config):
    prior = MotionPrior(prior_config)
    assert prior.encoder.posture_decoder is prior.decoder.posture
