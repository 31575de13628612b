"""Small networks, and pictures and keypoints for them."""

import pytest
import torch
from small_video import SMALL_DECOUPLING

from s2glib.papers.mddiffusion import MotionDecoupler


@pytest.fixture(autouse=True)
def seed():
    """Fresh networks draw their weights from torch's global generator."""
    torch.manual_seed(0)


@pytest.fixture
def config():
    return SMALL_DECOUPLING


@pytest.fixture
def decoupler():
    return MotionDecoupler(SMALL_DECOUPLING)


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
