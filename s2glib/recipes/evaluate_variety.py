"""Many motions for one sentence: how they differ, and how near the best of them comes.

Paper:    PT B, Fig. 6; diversity: authors' code
Notebook: notebooks/17_motion_distances.ipynb
"""

from functools import partial

import numpy as np
import torch
from jaxtyping import Float

from s2glib.corpus.script import split
from s2glib.metrics import sample_variance
from s2glib.papers.probtalk import Asked, ProbTalk
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.holistic_seen import joint_places, mirrored
from s2glib.recipes.predictor_scores import held_out, nothing_given
from s2glib.recipes.report import Row, figure, ratio

CLIPS, SAMPLES = 24, 32  # [PT B] generates 32 samples
_SEED = 11


def variety_rows(probtalk: ProbTalk, clips: HolisticClips) -> list[Row]:
    """32 samples for each of some clips, beside 32 real clips that have nothing to do with them."""
    pqvae, some = probtalk.pqvae, np.arange(CLIPS)
    windows = held_out(clips, pqvae.config.frames)
    asked = Asked(*(part[:CLIPS] for part in nothing_given(windows)))
    lengths = windows.lengths[some]
    places, others = partial(joint_places, pqvae.features), other_clips(probtalk)
    real = [clip[:n] for clip, n in zip(places(windows.motion[:CLIPS]), lengths, strict=True)]
    plain = ProbTalk(pqvae, probtalk.predictor, None, probtalk.hear)

    def crowds_of(system: ProbTalk) -> list[Float[np.ndarray, "samples _ 55 3"]]:
        generator = torch.Generator().manual_seed(_SEED)
        drawn = [places(system.sample(asked, generator=generator)) for _ in range(SAMPLES)]
        return [crowd[:, :n] for crowd, n in zip(np.stack(drawn, axis=1), lengths, strict=True)]

    def scores(crowds: list[Float[np.ndarray, "samples _ 55 3"]]) -> list[Float[np.ndarray, " n"]]:
        best = [nearest(crowd, truth) for crowd, truth in zip(crowds, real, strict=True)]
        return [np.array([sample_variance(crowd) for crowd in crowds]), np.array(best)]

    usual, best_other = scores([others[:, :n] for n in lengths])
    rows = []
    for system, name in ((probtalk, ""), (plain, ", not refined")):
        spread, best = scores(crowds_of(system))
        rows += [
            figure(f"diversity of 32 samples, m^2{name}", spread),
            ratio(f"diversity of 32 samples / of 32 real clips{name}", spread, usual),
            figure(f"best of 32 samples, cm^2{name}", 1e4 * best),
            ratio(f"best of 32 samples / of 32 real clips{name}", best, best_other),
        ]
    return rows


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
