"""ProbTalk in small, which nobody trained, for tests of what shows it."""

from dataclasses import replace

import torch

from s2glib.papers.probtalk import (
    PQVAE,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    TEACHING_REFINER,
    Predictor,
    ProbTalk,
    Refiner,
)


def small_probtalk() -> ProbTalk:
    """Thin networks; what they make is never still."""
    torch.manual_seed(0)
    pqvae = PQVAE(replace(TEACHING_PQVAE, widths=(8, 8, 8, 8), straight=0, latent=16, codes=6))
    pqvae.features.fit(0.2 * torch.randn(300, 55, 3), torch.rand(300, 100))
    for parameter in pqvae.decoder.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    small = {"audio_width": 8, "context_widths": (8, 8, 8), "codes": 6, "guidance": 3.0}
    thin = {"width": 16, "heads": 2, "layers": 1, "hidden": 16, "style": 8}
    predictor = Predictor(replace(TEACHING_PREDICTOR, **small, **thin))
    refiner = Refiner(replace(TEACHING_REFINER, head=16, **thin))
    refiner.features.load_state_dict(pqvae.features.state_dict())
    return ProbTalk(pqvae, predictor, refiner)
