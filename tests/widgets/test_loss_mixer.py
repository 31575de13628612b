import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.losses import masked_l1, total_variation
from s2glib.papers.mddiffusion import Masks
from s2glib.widgets.loss_mixer import KNOWN, SEVERAL, LossMixer, pixel_weights

SIZE = 32
REGIONS = ("valid", "occluded", "hand", "face")
WEIGHTS = st.fixed_dictionaries(dict.fromkeys(REGIONS, st.floats(0, 10)))


def spot(top, left, size=6):
    """A mask of one square."""
    mask = torch.zeros(1, SIZE, SIZE)
    mask[:, top : top + size, left : left + size] = 1
    return mask


def scene():
    """Three poses of a bright hand before a smooth wall, and a start without any hand."""
    wall = torch.linspace(0.3, 0.6, SIZE).expand(3, SIZE, SIZE)
    hands = torch.stack([spot(20, left) for left in (2, 13, 24)])
    truths = torch.where(hands > 0, torch.tensor([0.9, 0.7, 0.6])[:, None, None], wall)
    faces = spot(3, 12).expand(3, 1, SIZE, SIZE)
    visible = 1 - 0.8 * spot(18, 0, 12).expand(3, 1, SIZE, SIZE)
    return wall + 0.05 * faces[0], truths, Masks(visible, hands, faces)


SHARED = LossMixer(*scene())


def error(picture, mask, pose=0):
    _, truths, _ = scene()
    return float(masked_l1(truths[pose : pose + 1], picture[None], mask[None]))


@given(weights=WEIGHTS, seed=st.integers(0, 99))
def test_all_masked_terms_are_one_weight_at_every_pixel(weights, seed):
    generator = torch.Generator().manual_seed(seed)
    image, image_hat = torch.rand(2, 2, 3, 8, 9, generator=generator)
    regions = {name: torch.rand(2, 1, 8, 9, generator=generator) for name in REGIONS}
    terms = (weights[name] * masked_l1(image, image_hat, regions[name]) for name in REGIONS)
    one = (pixel_weights(regions, weights) * (image - image_hat).abs()).sum()
    torch.testing.assert_close(one, sum(terms), rtol=1e-4, atol=1e-5)


def test_without_any_term_nothing_changes():
    start, _, _ = scene()
    torch.testing.assert_close(SHARED.repaint(), start)


def test_a_term_repairs_its_own_region_and_leaves_the_rest():
    start, _, masks = scene()
    made = SHARED.repaint(hand=5.0)
    assert error(made, masks.hand[0]) < 0.1 * error(start, masks.hand[0])
    assert torch.equal(made * (1 - masks.hand[0]), start * (1 - masks.hand[0]))


def test_in_doubt_l1_leaves_the_hand_out_and_its_weight_paints_it_everywhere():
    start, _, masks = scene()
    plain = {"valid": 1.0, "occluded": 1.0}
    shy = SHARED.repaint(SEVERAL, **plain)
    bold = SHARED.repaint(SEVERAL, **plain, hand=5.0)
    for hand in masks.hand:
        assert ((shy - start).abs() * hand).max() < 0.02
        assert ((bold - start).abs() * hand).sum() > 0.5 * (hand.sum() * 3) * 0.2


def test_total_variation_wants_less_of_it():
    start = SHARED.repaint()
    assert total_variation(SHARED.repaint(total_variation=1.0)[None]) < 0.7 * total_variation(
        start[None]
    )


def test_perceptual_and_style_terms_lead_to_the_known_truth_s_colours():
    start, truths, _ = scene()
    for name, weight in {"perceptual": 1.0, "style": 120.0}.items():
        made = SHARED.repaint(KNOWN, **{name: weight})
        wanted = truths[0].mean(dim=(1, 2))
        assert (made.mean(dim=(1, 2)) - wanted).norm() < (start.mean(dim=(1, 2)) - wanted).norm()


def test_errors_are_in_percent_of_white_and_said_before_and_after():
    start, _, masks = scene()
    panel = SHARED.render(KNOWN, hand=5.0)
    before = 100 * error(start, masks.hand[0])
    assert f"hand {before:.1f} to {panel.facts['hand']:.1f}" in panel.alt
    assert panel.facts["face"] == pytest.approx(100 * error(start, masks.face[0]))


def test_it_tests_itself(capsys):
    LossMixer(*scene()).selftest()
    assert capsys.readouterr().out == "6 states, 6 distinct\n"


def test_the_same_weights_make_the_same_picture():
    assert SHARED.render(**SHARED.state) == SHARED.render(**SHARED.state)


def test_its_words_never_change():
    assert repr(SHARED).startswith("LossMixer: needs a running kernel; without one, .render(valid")


def test_an_unknown_term_is_refused():
    with pytest.raises(ValueError, match="no term is called hands"):
        SHARED.repaint(hands=5.0)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("cut", "truths"), [(slice(0, 16), slice(0, 3)), (slice(0, SIZE), slice(0, 2))]
)
def test_pictures_and_masks_of_other_sizes_are_refused(cut, truths):
    start, poses, masks = scene()
    with pytest.raises(ValueError, match="must have one size"):
        LossMixer(start[..., cut], poses[truths], masks)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("place", range(3))
def test_what_is_no_picture_and_no_mask_is_told(place):
    parts = list(scene())
    parts[place] = None
    with pytest.raises(TypeError, match=r"expected a picture, .* got .*None"):
        LossMixer(*parts)
