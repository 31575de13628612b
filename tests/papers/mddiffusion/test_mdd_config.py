from dataclasses import replace

import pytest

from s2glib.papers.mddiffusion import (
    PAPER_DECOUPLING,
    PAPER_REFINEMENT,
    TEACHING_DECOUPLING,
    TEACHING_DECOUPLING_128,
)


def test_the_papers_numbers():
    """[MDD B.5, B.3]"""
    paper = PAPER_DECOUPLING
    assert (paper.size, paper.transforms, paper.points, paper.flow_size) == (256, 20, 5, 64)
    assert paper.mask_sizes == (32, 64, 128, 256)
    assert len(PAPER_REFINEMENT.widths) == 8
    assert PAPER_REFINEMENT.residual_blocks == 2


def test_what_is_ours_is_off_in_the_paper():
    paper = PAPER_DECOUPLING
    assert (paper.visible_at_start, paper.keypoint_grid, paper.keypoint_early_pool) == (
        0.5,
        1,
        True,
    )
    assert not PAPER_REFINEMENT.adds


def test_the_larger_teaching_model_differs_in_size_only():
    assert replace(TEACHING_DECOUPLING_128, size=64, keypoint_size=None) == TEACHING_DECOUPLING
    assert TEACHING_DECOUPLING_128.mask_sizes == (16, 32, 64, 128)
    assert TEACHING_DECOUPLING_128.keypoint_shrinking == 2
    assert PAPER_DECOUPLING.keypoint_shrinking == TEACHING_DECOUPLING.keypoint_shrinking == 1


def test_keypoints_are_found_on_pictures_a_whole_number_of_times_smaller():
    with pytest.raises(ValueError, match="keypoint_size=48; take a divisor, or None"):
        replace(TEACHING_DECOUPLING_128, keypoint_size=48)


@pytest.mark.parametrize(
    "change",
    [
        {"flow_size": 48},
        {"flow_size": 128},
        {"flow_blocks": 1},
        {"flow_blocks": 6},
        {"synthesis_blocks": 4},
        {"size": 60, "flow_size": 60},
    ],
)
def test_sizes_that_do_not_fit_are_refused(change):
    with pytest.raises(ValueError, match="change size, flow_size, flow_blocks or synthesis_blocks"):
        replace(TEACHING_DECOUPLING, **change)
