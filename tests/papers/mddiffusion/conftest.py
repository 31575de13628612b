"""Small networks with every part of the large ones."""

from dataclasses import replace

import pytest
import torch

from s2glib.papers.mddiffusion import TEACHING_DECOUPLING, MotionDecoupler

SMALL = replace(
    TEACHING_DECOUPLING,
    size=32,
    transforms=3,
    keypoint_widths=(4, 4, 6, 8),
    keypoint_grid=2,
    flow_size=16,
    flow_width=4,
    flow_widest=8,
    flow_blocks=2,
    synthesis_width=4,
    synthesis_blocks=2,
)


@pytest.fixture(autouse=True)
def seed():
    """Fresh networks draw their weights from torch's global generator."""
    torch.manual_seed(0)


@pytest.fixture
def config():
    return SMALL


@pytest.fixture
def decoupler():
    return MotionDecoupler(SMALL)


@pytest.fixture
def images():
    """Two smooth colourful pictures and two more, as sources and drivings."""
    coarse = torch.rand(4, 3, 6, 6)
    fine = torch.nn.functional.interpolate(coarse, 32, mode="bicubic").clamp(0, 1)
    return fine[:2], fine[2:]


@pytest.fixture
def keypoints():
    """Three groups of five points, well apart, for two pictures."""
    angles = torch.arange(5) * 2 * torch.pi / 5
    ring = 0.3 * torch.stack([angles.cos(), angles.sin()], dim=-1)
    centres = torch.tensor([[-0.4, 0.1], [0.3, -0.3], [0.0, 0.4]])
    return (centres[:, None] + ring + 0.02 * torch.randn(5, 2)).expand(2, -1, -1, -1)
