"""Motion longer than a window: denoise overlapping windows together until they agree.

After every denoising step the windows are decoded, blended where they overlap, cut apart and
encoded again. So neighbours settle on one motion before it is sharp, and no seam is left to mend.
All windows of a recording take a step together, but a network sees only a few at a time.

Paper:    AM generates single windows; joint denoising after MultiDiffusion: ours
Notebook: notebooks/15_long_sequences.ipynb
"""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.layers import in_batches
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser
from s2glib.papers.amuse.motion_prior import MotionPrior

AT_ONCE = 64  # windows that a network sees together: three minutes of speech


def window_starts(frames: int, window: int, overlap: int) -> list[int]:
    """First frames of overlapping windows that cover `frames`; the last may reach beyond."""
    hop = window - overlap
    return list(range(0, max(frames - overlap, 1), hop))


def blend(
    windows: Float[Tensor, "n frames features"], overlap: int
) -> Float[Tensor, "total features"]:
    """One track from windows that overlap: a straight cross-fade in every overlap."""
    n, frames, features = windows.shape
    hop = frames - overlap
    fade = windows.new_ones(n, frames)
    ramp = (torch.arange(overlap, dtype=windows.dtype, device=windows.device) + 0.5) / overlap
    fade[1:, :overlap] = ramp
    fade[:-1, hop:] = 1 - ramp
    track = windows.new_zeros((n - 1) * hop + frames, features)
    for number in range(n):
        begin = number * hop
        track[begin : begin + frames] += fade[number, :, None] * windows[number]
    return track


def cut(
    track: Float[Tensor, "total features"], window: int, overlap: int
) -> Float[Tensor, "n frames features"]:
    """The overlapping windows of a track: the inverse of `blend` where windows agree."""
    return track.unfold(0, window, window - overlap).mT


def mend_joins(
    windows: Float[Tensor, "n frames features"], frames_per_token: int
) -> Float[Tensor, "n frames features"]:
    """Smooth the two frames where local tokens meet, (1 2 1) / 4.

    Each token draws its own frames, and sampled tokens do not meet exactly. Smoothing more than
    the joins would blunt the beats.
    """
    borders = torch.arange(frames_per_token, windows.shape[1], frames_per_token)
    joins = torch.cat([borders - 1, borders])
    mended = windows.clone()
    before, here, after = (windows[:, joins + step] for step in (-1, 0, 1))
    mended[:, joins] = (before + 2 * here + after) / 4
    return mended


def agreeing(
    denoise: Callable[[Tensor, int], Tensor],
    prior: MotionPrior,
    denoiser: LatentDenoiser,
    overlap: int,
) -> Callable[[Tensor, int], Tensor]:
    """Make `denoise` return latents of windows that agree where they overlap."""
    frames = prior.config.frames

    def denoise_together(xt: Tensor, t: int) -> Tensor:
        x0 = denoise(xt, t)
        if len(x0) == 1:
            return x0
        track = blend(in_batches(prior.decode, denoiser.restore(x0), size=AT_ONCE), overlap)
        posterior = in_batches(prior.encode, cut(track, frames, overlap), size=AT_ONCE)
        return denoiser.standardize(posterior.mean)

    return denoise_together
