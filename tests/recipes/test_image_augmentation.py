import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from s2glib.recipes.image_augmentation import JITTER, Augmentation, hue_rotation


@pytest.fixture
def images(rng):
    return torch.from_numpy(rng.random((200, 3, 5, 4))).float()


def test_hues_turn_as_scipy_turns_space(rng):
    angles = rng.uniform(-3, 3, 20)
    expected = Rotation.from_rotvec(angles[:, None] / 3**0.5 * np.ones(3)).as_matrix()
    np.testing.assert_allclose(hue_rotation(angles), expected, atol=1e-12)


def test_greys_change_their_brightness_only(rng):
    grey = torch.full((200, 3, 2, 2), 0.5)
    changed = Augmentation.draw(200, rng).change(grey)
    assert (changed - changed[:, :1]).abs().max() < 1e-6
    assert (changed / grey - 1).abs().amax() <= JITTER + 1e-6
    assert changed.std(dim=0).min() > 0.02


def test_half_of_the_pairs_are_mirrored_and_the_rest_is_not(images, rng):
    augmentation = Augmentation.draw(200, rng)
    mirrored = augmentation.mirror(images)
    assert torch.equal(mirrored[augmentation.mirrored], images[augmentation.mirrored].flip(-1))
    assert torch.equal(mirrored[~augmentation.mirrored], images[~augmentation.mirrored])
    assert 70 < int(augmentation.mirrored.sum()) < 130


def test_all_pictures_of_a_pair_change_alike(images, rng):
    augmentation = Augmentation.draw(200, rng)
    assert torch.equal(augmentation.change(images), augmentation.change(images))
    assert not torch.equal(augmentation.change(images), augmentation.mirror(images))


def test_pictures_stay_between_black_and_white(images, rng):
    changed = Augmentation.draw(200, rng).change(images.round())
    assert changed.min() >= 0
    assert changed.max() <= 1
