"""Ten seconds of speech, file in, motion out: the second call in one process, two threads.

Run: python -m pytest -s benchmarks/bench_gestures.py
"""

import pytest
import torch

from s2glib.audio import Waveform, load, save
from s2glib.data import load_clip
from s2glib.folders import data_folder
from s2glib.papers.amuse import Amuse
from s2glib.papers.probtalk import ProbTalk

SECONDS = 10
BAR = 1.0  # seconds


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    sound = load_clip("s04-voice_01-anger-t2").waveform
    samples = torch.from_numpy(sound.samples).repeat(3)[: SECONDS * sound.sample_rate]
    path = tmp_path_factory.mktemp("speech") / "ten_seconds.wav"
    save(path, Waveform(samples.numpy(), sound.sample_rate))
    return path


@pytest.mark.parametrize("system", [Amuse, ProbTalk])
def test_ten_seconds_of_speech_become_motion(benchmark, recording, system, capsys):
    torch.set_num_threads(2)
    model = system.load(data_folder() / "checkpoints")

    def file_to_motion():
        return model.generate(load(recording), generator=torch.Generator().manual_seed(0))

    motion = benchmark.pedantic(file_to_motion, warmup_rounds=1, rounds=5)
    assert motion.frames == SECONDS * 30
    median = benchmark.stats.stats.median
    with capsys.disabled():
        print(f"\n{system.__name__}: {median:.2f} s for {SECONDS} s of speech")
    assert median < BAR
