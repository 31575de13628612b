"""A motion prior that trains in minutes: one token for posture, eight for what happens when.

Both directions have a linear path, started from principal components, and a residual path of
temporal convolutions that starts at zero. So training begins as PCA and only improves on it.

Paper:    AM C.1 (role of the prior), networks: ours
Notebook: notebooks/12_motion_prior.ipynb
"""

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import ResidualConv
from s2glib.papers.amuse.config import PriorConfig

FRAMES_PER_PATCH = 5
_START_LOG_VAR = -4.0


def _blocks(channels: int, dilations: tuple[int, ...]) -> nn.Sequential:
    return nn.Sequential(*(ResidualConv(channels, dilation) for dilation in dilations))


def _zeroed(layer: nn.Linear | nn.Conv1d) -> nn.Linear | nn.Conv1d:
    for parameter in layer.parameters():
        nn.init.zeros_(parameter)
    return layer


def principal_components(
    rows: Float[Tensor, "n d"], count: int
) -> tuple[Float[Tensor, " d"], Float[Tensor, "d count"]]:
    """Mean and first components of many rows, each component scaled to unit variance."""
    mean = rows.mean(0)
    variance, directions = torch.linalg.eigh((rows - mean).T @ (rows - mean) / len(rows))
    scale = variance.flip(0)[:count].clamp_min(1e-8).sqrt()
    return mean, directions.flip(1)[:, :count] * scale


def _set_linear(encode: nn.Linear, decode: nn.Linear, mean: Tensor, basis: Tensor) -> None:
    """Make a pair of linear maps the projection on a basis and its inverse."""
    inverse = torch.linalg.pinv(basis)
    with torch.no_grad():
        encode.weight.copy_(inverse)
        encode.bias.copy_(-inverse @ mean)
        decode.weight.copy_(basis)
        decode.bias.copy_(mean)


class TemporalMotionEncoder(nn.Module):
    """Motion to the mean and log-variance of its tokens."""

    def __init__(self, config: PriorConfig, posture_decoder: nn.Linear):
        super().__init__()
        self.locals = config.tokens - 1
        patch = config.frames // self.locals
        self.posture = nn.Linear(config.features, config.token_dim)
        self.change = nn.Linear(patch * config.features, config.token_dim)
        self.posture_decoder = posture_decoder
        width, dim = config.width, config.token_dim
        stride = patch // FRAMES_PER_PATCH
        self.into = nn.Conv1d(FRAMES_PER_PATCH * config.features, width, 1)
        self.fine = _blocks(width, (1, 2))
        self.down = nn.Conv1d(width, width, stride, stride)
        self.coarse = _blocks(width, (1, 1))
        self.to_local = _zeroed(nn.Conv1d(width, 2 * dim, 1))
        self.to_global = _zeroed(nn.Linear(2 * width, 2 * dim))

    def forward(self, motion: Float[Tensor, "batch frames features"]) -> tuple[Tensor, Tensor]:
        """Mean and log-variance, (batch, tokens, dim) each; the first token is global."""
        patches = rearrange(motion, "b (n p) f -> b (p f) n", p=FRAMES_PER_PATCH)
        h = self.coarse(self.down(self.fine(self.into(patches))))
        local_residual, local_log_var = self.to_local(h).mT.chunk(2, dim=-1)
        pooled = torch.cat([h.mean(-1), h.amax(-1)], dim=-1)
        global_residual, global_log_var = self.to_global(pooled).chunk(2, dim=-1)
        posture = self.posture(motion.mean(dim=1))
        rest = motion - self.posture_decoder(posture)[:, None]
        local = self.change(rearrange(rest, "b (n p) f -> b n (p f)", n=self.locals))
        mean = torch.cat([(posture + global_residual)[:, None], local + local_residual], dim=1)
        log_var = torch.cat([global_log_var[:, None], local_log_var], dim=1)
        return mean, (log_var + _START_LOG_VAR).clamp(-10, 4)


class TemporalMotionDecoder(nn.Module):
    """Tokens to motion: posture, plus what each local token adds, plus a learned residual."""

    def __init__(self, config: PriorConfig):
        super().__init__()
        self.locals = config.tokens - 1
        patch = config.frames // self.locals
        self.posture = nn.Linear(config.token_dim, config.features)
        self.change = nn.Linear(config.token_dim, patch * config.features)
        width, dim = config.width, config.token_dim
        stride = patch // FRAMES_PER_PATCH
        self.into = nn.Conv1d(dim, width, 1)
        self.from_global = nn.Linear(dim, width)
        self.coarse = _blocks(width, (1, 1))
        self.up = nn.ConvTranspose1d(width, width, stride, stride)
        self.fine = _blocks(width, (1, 2, 1))
        self.out = _zeroed(nn.Conv1d(width, FRAMES_PER_PATCH * config.features, 1))

    def forward(
        self, tokens: Float[Tensor, "batch tokens dim"]
    ) -> Float[Tensor, "batch frames features"]:
        """Draw the motion that the tokens describe."""
        whole, local = tokens[:, 0], tokens[:, 1:]
        change = rearrange(
            self.change(local), "b n (p f) -> b (n p) f", f=self.posture.out_features
        )
        h = self.into(local.mT) + self.from_global(whole)[..., None]
        h = self.out(self.fine(self.up(self.coarse(h))))
        residual = rearrange(h, "b (p f) n -> b (n p) f", p=FRAMES_PER_PATCH)
        return self.posture(whole)[:, None] + change + residual


def start_from_components(
    encoder: TemporalMotionEncoder,
    decoder: TemporalMotionDecoder,
    clips: Float[Tensor, "n frames features"],
) -> None:
    """Set the linear paths to principal components of postures and of patches."""
    dim = encoder.posture.out_features
    mean, basis = principal_components(clips.mean(dim=1), dim)
    _set_linear(encoder.posture, decoder.posture, mean, basis)
    with torch.no_grad():
        rest = clips - decoder.posture(encoder.posture(clips.mean(dim=1)))[:, None]
    rows = rearrange(rest, "b (n p) f -> (b n) (p f)", n=encoder.locals)
    mean, basis = principal_components(rows, dim)
    _set_linear(encoder.change, decoder.change, mean, basis)
