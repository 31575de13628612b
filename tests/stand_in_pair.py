"""A pair of pictures and an untrained decoupler's reconstruction, for tests of what shows them."""

import torch
from torch import Tensor

from s2glib.papers.mddiffusion import TEACHING_DECOUPLING, MotionDecoupler, Reconstruction
from s2glib.widgets.tps_pad import sample_picture


def stand_in_pair() -> tuple[Tensor, Tensor, Reconstruction]:
    """A face, the face moved aside, and eight bold warps between points that nobody trained."""
    torch.manual_seed(0)
    decoupler = MotionDecoupler(TEACHING_DECOUPLING).eval()
    source = torch.from_numpy(sample_picture(64)).float()[None]
    here = 1.6 * torch.rand(1, 8, 5, 2) - 0.8
    there = here + 0.15 * torch.randn(1, 8, 5, 2)
    synthesis, flow = decoupler.animate(source, here, there)
    return source, source.roll(4, dims=-1), Reconstruction(here, there, flow, synthesis)
