import math

import matplotlib
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from stand_in_pair import stand_in_pair

from s2glib.warping import warp_features
from s2glib.widgets.mask_mixer import MaskMixer

matplotlib.use("Agg")
SOURCE, DRIVING, MADE = stand_in_pair()
SHARED = MaskMixer(SOURCE, DRIVING, MADE)
COUNT = 9  # eight warps and the background
INDICES = st.integers(0, COUNT - 1)


@pytest.fixture
def mixer():
    return MaskMixer(SOURCE, DRIVING, MADE)


def news(mixer, number=None, **change):
    """What the page sends when something was moved."""
    mix = {"gains": mixer.gains, "alone": mixer.alone, "painted": mixer.painted, **change}
    mixer.heard = {"number": mixer.order["number"] if number is None else number, **mix}


@pytest.mark.parametrize("painted", [False, True])
def test_at_first_the_mixture_is_the_networks(mixer, painted):
    mixer.paint(painted)
    made = MADE.synthesis.image if painted else MADE.synthesis.warped
    torch.testing.assert_close(mixer.picture, made[0].detach(), atol=1e-5, rtol=0)
    assert mixer.error == pytest.approx(mixer.network_error, abs=1e-6)
    assert mixer.error == pytest.approx((made - DRIVING).abs().mean().item(), abs=1e-6)


def test_the_error_of_copying_is_that_of_the_source(mixer):
    assert mixer.copying_error == pytest.approx((SOURCE - DRIVING).abs().mean().item())
    assert mixer.copying_error > 0.01


@given(INDICES, st.floats(-7.5, 8))
def test_a_gain_multiplies_a_warps_odds_by_its_exponential(index, gain):
    SHARED.reset()
    SHARED.set(index, gain)
    others = [k for k in range(COUNT) if k != index]
    shares = MADE.flow.contributions[0].detach().double(), SHARED.contributions.double()
    before, after = (share[index] / share[others].sum(0) for share in shares)
    torch.testing.assert_close(after, math.exp(gain) * before, rtol=0.01, atol=1e-5)


@given(INDICES, st.floats(-math.inf, -8))
def test_a_warp_that_is_off_has_no_share(index, gain):
    SHARED.reset()
    SHARED.set(index, gain)
    assert SHARED.gains[index] == -8
    assert SHARED.contributions[index].max() < 1e-30
    torch.testing.assert_close(SHARED.contributions.sum(0), torch.ones(32, 32))


@pytest.mark.parametrize("index", range(COUNT))
def test_a_warp_alone_bends_the_source_whatever_its_gain(mixer, index):
    mixer.set(index, -math.inf)
    mixer.solo(index)
    bent = warp_features(SOURCE, MADE.flow.warps[:, index].detach())[0]
    torch.testing.assert_close(mixer.picture, bent, atol=1e-5, rtol=0)


def test_only_differences_of_gains_count(mixer):
    for gain in (3.0, -math.inf):
        for index in range(COUNT):
            mixer.set(index, gain)
        assert mixer.error == pytest.approx(mixer.network_error, abs=1e-5)


def test_where_nothing_is_occluded_paint_changes_nothing(mixer):
    mixer.set(2, 5.0)
    visible = MADE.flow.occlusion_masks[-1][0].detach()
    bent, paint = mixer.picture, (MADE.synthesis.image - MADE.synthesis.warped * visible)[0]
    mixer.paint(True)
    torch.testing.assert_close(mixer.picture, visible * bent + paint.detach(), atol=1e-6, rtol=0)


def test_a_slider_moved_in_the_page_is_heard_and_the_error_can_be_observed(mixer):
    errors = []
    mixer.observe(lambda change: errors.append(change["new"]), "error")
    news(mixer, gains=[*mixer.gains[:8], 4.5], painted=True)
    assert mixer.gains[8] == 4.5
    assert mixer.painted
    assert errors == [pytest.approx((mixer.picture - DRIVING[0]).abs().mean().item())]


def test_news_from_before_an_order_is_not_believed(mixer):
    mixer.set(1, 2.0)
    news(mixer, number=0, gains=[0.0] * COUNT)
    assert mixer.gains[1] == 2.0


def test_news_is_not_sent_back_as_an_order(mixer):
    before = mixer.order
    news(mixer, alone=3)
    assert mixer.alone == 3
    assert mixer.order == before


def test_after_a_burst_a_reset_is_the_network_again(mixer):
    mixer.paint(True)
    for step in range(100):
        mixer.set(step % COUNT, step / 10 - 5)
        mixer.solo(step % COUNT)
    mixer.reset()
    assert mixer.error == pytest.approx(mixer.network_error, abs=1e-6)
    start = {"gains": [0.0] * COUNT, "alone": None, "painted": True}
    assert mixer.order == {"number": 202, **start}


def test_the_page_gets_pictures_and_warps_in_few_bytes(mixer, read):
    scene = read(mixer.scene)
    assert np.abs(scene["source"] / 65535 - SOURCE[0].numpy()).max() < 1e-5
    warps = MADE.flow.warps[0].detach().numpy()
    np.testing.assert_array_equal(scene["warps"], warps.transpose(0, 3, 1, 2))
    assert len(mixer.scene) < 400_000


def test_drawn_it_shows_three_pictures_and_a_thumbnail_of_each_warp(mixer):
    axes = Figure().add_subplot()
    mixer.set(4, 3.0)
    assert mixer.draw(axes) is axes
    shown = [image.get_array() for image in axes.images]
    assert len(shown) == 3 + COUNT
    np.testing.assert_allclose(shown[2], mixer.picture.permute(1, 2, 0).clip(0, 1), atol=1e-6)
    assert axes.texts[2].get_text() == f"mix (error {mixer.error:.3f})"


def test_a_thumbnail_is_tinted_where_its_warp_counts(mixer):
    mixer.solo(0)
    axes = mixer.draw(Figure().add_subplot())
    background, first = (np.asarray(image.get_array()) for image in axes.images[3:5])
    assert np.ptp(first, axis=-1).max() < 1e-6  # grey
    assert (background[..., 0] - background[..., 2]).min() > 0.5


def test_its_words_never_change(mixer):
    before = repr(mixer)
    mixer.set(0, 1.0)
    assert repr(mixer) == before
    assert len(before) < 110


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("pair", "kind", "fault"),
    [
        ((SOURCE.numpy(), DRIVING), TypeError, "source must be a float32 tensor"),
        ((SOURCE, DRIVING.double()), TypeError, "driving must be a float32 tensor"),
        ((SOURCE[0], DRIVING), ValueError, "a batch of one square picture"),
        ((SOURCE, DRIVING.expand(2, 3, 64, 64)), ValueError, "a batch of one square picture"),
        ((SOURCE, DRIVING[..., :40]), ValueError, "a batch of one square picture"),
        ((SOURCE, DRIVING[..., :40, :40]), ValueError, "one size, got 64 and 40"),
        ((SOURCE * 255, DRIVING), ValueError, "divide bytes by 255"),
        ((SOURCE, DRIVING * math.nan), ValueError, "driving must have values from 0 to 1"),
        ((DRIVING, SOURCE), ValueError, "another source picture"),
    ],
)
def test_pictures_that_are_no_pair_are_refused(pair, kind, fault):
    with pytest.raises(kind, match=fault):
        MaskMixer(*pair, MADE)


@pytest.mark.usefixtures("without_type_hook")
def test_a_reconstruction_of_something_else_is_refused():
    with pytest.raises(TypeError, match="what MotionDecoupler returns, got Flow"):
        MaskMixer(SOURCE, DRIVING, MADE.flow)
    two = MADE._replace(synthesis=MADE.synthesis._replace(warped=SOURCE.expand(2, 3, 64, 64)))
    with pytest.raises(ValueError, match="this one pair"):
        MaskMixer(SOURCE, DRIVING, two)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("index", [-1, COUNT, 1.5, "2"])
def test_a_warp_that_is_not_there_is_refused(mixer, index):
    for change in (lambda: mixer.set(index, 1.0), lambda: mixer.solo(index)):
        with pytest.raises(ValueError, match="1 to 8 are the warps"):
            change()


def test_a_gain_that_is_no_number_is_refused(mixer):
    with pytest.raises(ValueError, match="NaN"):
        mixer.set(1, math.nan)
