"""The latent denoiser: from a noisy motion latent and (c, e, s) back to the clean one.

Paper:    AM C.1, Fig. A.4-A.5
Notebook: notebooks/13_latent_diffusion.ipynb
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.layers import AdaptiveLayer, SkipTransformer, fixed_positions, sinusoidal_embedding
from s2glib.papers.amuse.config import DenoiserConfig
from s2glib.papers.amuse.disentangler import SpeechLatents

_TIME_WAVES = 256  # authors' code


class SpeechCondition(NamedTuple):
    """What the speech asks of a motion window.

    `tracks` are values per frame, unread by a network without `track_features`; `dropped` marks
    which of c, e and s the network must do without (it then sees a learned stand-in).
    """

    latents: SpeechLatents
    tracks: Float[Tensor, "batch frames tracks"]
    dropped: Bool[Tensor, "batch 3"]

    def without_emotion(self) -> "SpeechCondition":
        """The same condition with the emotion dropped: what guidance moves away from."""
        dropped = self.dropped.clone()
        dropped[:, 1] = True
        return self._replace(dropped=dropped)


class LatentDenoiser(nn.Module):
    """Delta: predicts the clean latent (or the noise, see `config.prediction`).

    Latents are standardised per kind of token; the statistics travel with the model.
    """

    config_class = DenoiserConfig
    latent_mean: Tensor
    latent_std: Tensor

    def __init__(self, config: DenoiserConfig):
        super().__init__()
        self.config = config
        width, dim = config.width, config.token_dim
        self.register_buffer("latent_mean", torch.zeros(config.tokens, dim))
        self.register_buffer("latent_std", torch.ones(config.tokens, dim))
        sizes = (config.content_dim, config.emotion_dim, config.style_dim)
        self.embed = nn.Linear(dim, width)
        self.conditions = nn.ModuleList(nn.Linear(size, width) for size in sizes)
        self.missing = nn.Parameter(0.02 * torch.randn(len(sizes), width))
        self.time = nn.Sequential(nn.Linear(_TIME_WAVES, width), nn.SiLU(), nn.Linear(width, width))
        per_token = config.track_features * config.frames_per_token
        self.tracks = nn.Linear(per_token, width) if per_token else None
        self.out_norm = nn.LayerNorm(width)
        self.out = nn.Linear(width, dim)
        if config.backbone == "adaptive":
            layers: list[nn.Module] = [
                AdaptiveLayer(width, config.heads, config.hidden, width)
                for _ in range(config.layers)
            ]
            tokens = config.tokens
            nn.init.zeros_(self.out.weight)
            nn.init.zeros_(self.out.bias)
        else:
            layers = [
                nn.TransformerEncoderLayer(
                    width, config.heads, config.hidden, activation="gelu", batch_first=True
                )
                for _ in range(config.layers)
            ]
            tokens = config.tokens + 1 + len(sizes)
        self.positions = nn.Parameter(0.3 * fixed_positions(tokens, width))
        self.layers = SkipTransformer(layers, width)

    def standardize(
        self, latents: Float[Tensor, "*b tokens dim"]
    ) -> Float[Tensor, "*b tokens dim"]:
        """Latents of the prior as the diffusion sees them."""
        return (latents - self.latent_mean.to(latents)) / self.latent_std.to(latents)

    def restore(self, latents: Float[Tensor, "*b tokens dim"]) -> Float[Tensor, "*b tokens dim"]:
        """Back to latents of the prior."""
        return latents * self.latent_std + self.latent_mean

    def forward(
        self,
        xt: Float[Tensor, "batch tokens dim"],
        t: Int[Tensor, " batch"] | int,
        condition: SpeechCondition,
    ) -> Float[Tensor, "batch tokens dim"]:
        """Predict x0 (or the noise) from a noisy, standardised latent at level t."""
        levels = torch.as_tensor(t, device=xt.device).expand(len(xt))
        time = self.time(sinusoidal_embedding(levels, _TIME_WAVES))
        wishes = self._wishes(condition)
        h = self._with_tracks(self.embed(xt), condition)
        if self.config.backbone == "adaptive":
            h = self.layers(h + self.positions, time + wishes.sum(dim=1))
        else:
            h = torch.cat([h, time[:, None], wishes], dim=1)  # z, t, c, e, s
            h = self.layers(h + self.positions)
        return self.out(self.out_norm(h[:, : self.config.tokens]))

    def _wishes(self, condition: SpeechCondition) -> Float[Tensor, "batch 3 width"]:
        seen = [
            embed(latent) for embed, latent in zip(self.conditions, condition.latents, strict=True)
        ]
        return torch.where(condition.dropped[..., None], self.missing, torch.stack(seen, dim=1))

    def _with_tracks(self, h: Tensor, condition: SpeechCondition) -> Tensor:
        """Add to each local token what the speech does during its frames."""
        if self.tracks is None:
            return h
        frames = self.config.frames_per_token
        tracks = condition.tracks.unflatten(1, (-1, frames)).flatten(2)  # (batch, locals, ...)
        return h + F.pad(self.tracks(tracks), (0, 0, self.config.global_tokens, 0))
