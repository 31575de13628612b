"""Ten seconds of film: one picture driven by 250 others, keypoints and refinement included.

By the shipped networks of 64 and of 128 pixels. Second call in one process, two threads.

Run: python -m pytest -s benchmarks/bench_video.py
"""

import pytest
import torch

from s2glib.folders import data_folder
from s2glib.papers.mddiffusion import MDDiffusion

FRAMES = 250
BAR = 35.0  # seconds


@pytest.mark.parametrize("size", [64, 128])
def test_ten_seconds_of_film_are_made_in_time(benchmark, size, capsys):
    torch.set_num_threads(2)
    model = MDDiffusion.load(data_folder() / "checkpoints", size=size)
    film = torch.rand(FRAMES, 3, size, size, generator=torch.Generator().manual_seed(0))
    video = benchmark.pedantic(model.reenact, (film[0], film), warmup_rounds=1, rounds=3)
    assert video.frames.shape == film.shape
    median = benchmark.stats.stats.median
    with capsys.disabled():
        print(f"\n{size} px: {FRAMES / median:.0f} frames a second; 10 s in {median:.1f} s")
    assert median < BAR
