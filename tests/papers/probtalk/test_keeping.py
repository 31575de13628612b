import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.body import PELVIS_HEIGHT, Motion, joint
from s2glib.papers.probtalk.keeping import EASE, bridged, eased, embody, kept_parts
from s2glib.papers.probtalk.motion_features import JOINTS_OF, PARTS

FRAMES = 20


def motion(frames=FRAMES, seed=0, dtype=torch.float32, fps=30):
    generator = torch.Generator().manual_seed(seed)
    shapes = ((55, 3), (3,), (100,))
    tracks = (torch.randn(frames, *shape, generator=generator, dtype=dtype) for shape in shapes)
    return Motion(*tracks, fps)


@pytest.fixture
def made():
    return motion(seed=1)


def masks(frames=FRAMES):
    return st.integers(0, 2 ** (4 * frames) - 1).map(
        lambda bits: torch.tensor([bool(bits >> n & 1) for n in range(4 * frames)]).view(frames, 4)
    )


@given(masks(), st.sampled_from([torch.float32, torch.float64]))
def test_what_is_kept_is_copied_bit_for_bit_and_nothing_else(kept, dtype):
    made, known = motion(seed=1), motion(dtype=dtype)
    result = embody(made.poses, made.expression, known, kept)
    for column, part in enumerate(PARTS):
        frames, joints = kept[:, column], JOINTS_OF[part]
        assert torch.equal(result.poses[frames][:, joints], known.poses[frames][:, joints])
        loose = ~frames
        assert torch.equal(result.poses[loose][:, joints], made.poses[loose][:, joints].to(dtype))
    face, body = kept[:, 0], kept[:, 1]
    assert torch.equal(result.expression[face], known.expression[face])
    assert torch.equal(result.expression[~face], made.expression[~face].to(dtype))
    assert torch.equal(result.trans[body], known.trans[body])


def test_a_frame_that_is_kept_whole_is_the_known_frame(made):
    known, kept = motion(), torch.zeros(FRAMES, 4, dtype=torch.bool)
    kept[5:9] = True
    result = embody(made.poses, made.expression, known, kept)
    for name in ("poses", "trans", "expression"):
        assert torch.equal(getattr(result, name)[5:9], getattr(known, name)[5:9])


def test_with_nothing_known_the_body_stands(made):
    result = embody(made.poses, made.expression, None, torch.zeros(FRAMES, 4, dtype=torch.bool))
    assert torch.equal(result.poses, made.poses)
    assert (result.trans == torch.tensor([0.0, PELVIS_HEIGHT, 0.0])).all()
    assert result.fps == 30


def test_legs_go_straight_from_one_kept_frame_to_the_next(made):
    known, kept = motion(), torch.zeros(FRAMES, 4, dtype=torch.bool)
    kept[[4, 12], 1] = True
    result = embody(made.poses, made.expression, known, kept)
    knee = joint("left_knee")
    middle = (known.poses[4, knee] + known.poses[12, knee]) / 2
    torch.testing.assert_close(result.poses[8, knee], middle)
    assert torch.equal(result.poses[19, knee], known.poses[12, knee])


@given(st.lists(st.booleans(), min_size=2, max_size=30))
def test_bridges_are_numpys_interpolation(bits):
    kept = torch.tensor(bits)
    track, made = torch.randn(len(bits), 1, dtype=torch.float64), torch.zeros(len(bits), 1).double()
    result = bridged(track, made, kept)
    if not any(bits):
        assert torch.equal(result, made)
        return
    places = np.flatnonzero(bits)
    expected = np.interp(np.arange(len(bits)), places, track[places, 0])
    np.testing.assert_allclose(result[:, 0], expected, atol=1e-12)
    assert torch.equal(result[kept], track[kept])


@given(st.integers(0, 1000))
def test_easing_keeps_what_is_known_and_meets_it(seed):
    generator = torch.Generator().manual_seed(seed)
    known = torch.rand(2, 40, 3, generator=generator) < 0.2
    given_track = torch.zeros(2, 40, 3)
    made = torch.ones(2, 40, 3)
    result = eased(given_track, made, known)
    assert (result[known] == 0).all()
    assert ((result >= 0) & (result <= 1)).all()
    beside = known[:, :-1] & ~known[:, 1:]
    assert (result[:, 1:][beside] < 0.1).all()


def test_far_from_what_is_known_nothing_is_eased():
    made, known = torch.randn(1, 60, 2), torch.zeros(1, 60, 2, dtype=torch.bool)
    known[:, 20:30, 0] = True
    result = eased(torch.randn(1, 60, 2), made, known)
    assert torch.equal(result[..., 1], made[..., 1])
    far = [*range(20 - EASE - 1), *range(30 + EASE, 60)]
    torch.testing.assert_close(result[0, far, 0], made[0, far, 0])


def test_easing_stays_on_its_device():
    with torch.device("meta"):
        track, known = torch.zeros(2, 40, 3), torch.zeros(2, 40, 3, dtype=torch.bool)
    result = eased(track, track, known)
    assert (result.device.type, result.shape) == ("meta", track.shape)


def test_without_a_mask_all_of_a_known_motion_is_kept():
    kept = kept_parts(motion(8), None, FRAMES)
    assert kept[:8].all()
    assert not kept[8:].any()


def test_without_a_known_motion_nothing_is_kept():
    assert not kept_parts(None, None, FRAMES).any()


@pytest.mark.parametrize(
    ("known", "mask", "error", "reason"),
    [
        (None, torch.ones(FRAMES, 4).bool(), ValueError, "give one"),
        (torch.zeros(FRAMES, 55, 3), None, TypeError, "must be a Motion"),
        (motion(fps=25), None, ValueError, "30 frames a second, got 25"),
        (motion(), torch.ones(FRAMES, 4), TypeError, "bools"),
        (motion(), [[True] * 4] * FRAMES, TypeError, "bools"),
        (motion(), torch.ones(FRAMES + 1, 4).bool(), ValueError, r"must be \(20, 4\)"),
        (motion(), torch.ones(FRAMES, 3).bool(), ValueError, "face, body, left_hand, right_hand"),
        (motion(8), torch.ones(FRAMES, 4).bool(), ValueError, "ends after 8 frames"),
    ],
)
def test_doors(without_type_hook, known, mask, error, reason):
    with pytest.raises(error, match=reason):
        kept_parts(known, mask, FRAMES)
