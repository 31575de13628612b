from dataclasses import replace

import pytest
import torch

from s2glib.papers.amuse import PatchEncoder, patch_grid
from s2glib.papers.amuse.speech_encoder import PATCH, STRIDE


def test_ten_seconds_have_1212_patches():
    rows, columns = patch_grid(n_mels=128, frames=1024)
    assert (rows, columns) == (12, 101)
    assert rows * columns == 1212


@pytest.mark.parametrize(("mels", "frames"), [(16, 16), (25, 26), (128, 100)])
def test_the_grid_is_where_windows_fit(mels, frames):
    places = [range(0, size - PATCH + 1, STRIDE) for size in (mels, frames)]
    assert patch_grid(mels, frames) == tuple(len(place) for place in places)


@pytest.mark.parametrize(("mels", "frames"), [(15, 1024), (128, 8)])
def test_a_filterbank_without_a_patch_is_refused(mels, frames):
    with pytest.raises(ValueError, match=f"{frames} x {mels} filterbank has none"):
        patch_grid(mels, frames)


@pytest.fixture
def encoder(speech_config):
    config = replace(speech_config, backbone="patches", n_mels=26, frames=36, layers=1)
    return PatchEncoder(config, latent_dim=5).eval()


def test_a_patch_token_is_a_linear_map_of_16_mels_by_16_frames(encoder):
    filterbank = torch.randn(1, 36, 26)
    tokens = encoder.patches(filterbank.mT[:, None])
    assert tokens.shape[-2:] == patch_grid(26, 36)
    patch = filterbank[0, 20:36, 10:26].T  # second row of patches, third column
    expected = encoder.patches.weight.flatten(1) @ patch.flatten() + encoder.patches.bias
    torch.testing.assert_close(tokens[0, :, 1, 2], expected)


def test_the_latent_is_read_off_the_mean_patch(encoder):
    seen = {}
    encoder.norm.register_forward_hook(lambda _, __, out: seen.update(tokens=out))
    latent = encoder(torch.randn(2, 36, 26))
    torch.testing.assert_close(latent, encoder.project(seen["tokens"][:, 2:].mean(dim=1)))
    assert seen["tokens"].shape == (2, 2 * 3 + 2, 16)
