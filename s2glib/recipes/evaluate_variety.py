"""Many motions for one sentence: how they differ, and how near the best of them comes.

Paper:    PT B, Fig. 6; diversity: authors' code
Notebook: notebooks/17_motion_distances.ipynb
"""

import numpy as np
import torch
from jaxtyping import Float

from s2glib.corpus.script import split
from s2glib.metrics import sample_variance
from s2glib.papers.probtalk import ProbTalk
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.holistic_seen import held, joint_places, mirrored
from s2glib.recipes.predictor_scores import held_out, nothing_given
from s2glib.recipes.report import Row, figure, ratio

CLIPS, SAMPLES = 24, 32  # [PT B] generates 32 samples
_SEED = 11


def variety_rows(probtalk: ProbTalk, clips: HolisticClips) -> list[Row]:
    """32 samples for each of some clips, beside 32 real clips that have nothing to do with them."""
    pqvae, some = probtalk.pqvae, np.arange(CLIPS)
    windows = held_out(clips, pqvae.config.frames)
    asked = nothing_given(type(windows)(*(part[:CLIPS] for part in windows)))
    generator = torch.Generator().manual_seed(_SEED)
    drawn = [probtalk.sample(asked, generator=generator) for _ in range(SAMPLES)]
    lengths = clips.motion.lengths[some]
    real = joint_places(pqvae.features, held(windows.motion[:CLIPS], lengths))
    made = np.stack([joint_places(pqvae.features, held(m, lengths)) for m in drawn], axis=1)
    others = other_clips(probtalk)
    spread = np.array([sample_variance(samples) for samples in made])
    best, best_other = (
        np.array([nearest(crowd, truth) for crowd, truth in zip(crowds, real, strict=True)])
        for crowds in (made, [others] * CLIPS)
    )
    return [
        figure("diversity of 32 samples, m^2", spread),
        figure("diversity of 32 samples / of 32 real clips", spread / sample_variance(others)),
        figure("best of 32 samples, cm^2", 1e4 * best),
        ratio("best of 32 samples / of 32 real clips", best, best_other),
    ]


def other_clips(probtalk: ProbTalk) -> Float[np.ndarray, "samples frames 55 3"]:
    """Joints of some training clips."""
    train = split("train")
    drawn = np.random.default_rng(_SEED).choice(len(train), SAMPLES, replace=False)
    clips = holistic_clips([train[row] for row in drawn], probtalk.pqvae.features)
    return joint_places(probtalk.pqvae.features, clips.first(probtalk.pqvae.config.frames))


def nearest(
    samples: Float[np.ndarray, "samples frames 55 3"], truth: Float[np.ndarray, "frames 55 3"]
) -> float:
    """Mean squared distance of joints to those of the best sample, in a mirror if need be.

    [PT Fig. 6] takes movements of corresponding parts, such as left and right hands, as equal.
    """
    both = np.stack([truth, mirrored(truth)])[:, None]
    return float(np.square(samples - both).sum(-1).mean(axis=(2, 3)).min())
