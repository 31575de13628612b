from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.probtalk import PAPER_PQVAE, PQVAE, TEACHING_PQVAE, PQVAELosses, pqvae_losses
from s2glib.papers.probtalk.pqvae import Resample, ResidualStack

NARROW = replace(PAPER_PQVAE, widths=(8, 8, 12, 16), latent=16, codes=6)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def model():
    return PQVAE(NARROW)


@pytest.fixture
def motion():
    return torch.randn(3, 32, 376)


def shapes_along(network, x):
    found = []
    for layer in network:
        x = layer(x)
        if isinstance(layer, ResidualStack | Resample | torch.nn.Conv1d):
            found.append(tuple(x.shape[1:]))
    return found


def test_the_papers_encoder_and_decoder_layer_by_layer():
    with torch.device("meta"):
        model = PQVAE(PAPER_PQVAE)
        encoding = shapes_along(model.encoder, torch.zeros(2, 376, 176))
        decoding = shapes_along(model.decoder, torch.zeros(2, 512, 22))
    down = [(256, 176), (256, 176), (256, 88), (256, 88), (512, 44), (512, 44), (1024, 22)]
    assert encoding == [*down, (1024, 22), (512, 22)]
    up = [(1024, 22), (1024, 22), (512, 44), (512, 44), (256, 88), (256, 88), (256, 176)]
    assert decoding == [*up, (256, 176), (376, 176)]


def test_the_papers_sizes():
    with torch.device("meta"):
        model = PQVAE(PAPER_PQVAE)
        made, quantized = model(torch.zeros(2, 176, 376))
    assert made.shape == (2, 176, 376)
    assert quantized.codes.shape == (2, 22, 4)
    assert model.quantizer.codebooks.shape == (4, 128, 128)
    encoder, decoder = (
        sum(p.numel() for p in part.parameters()) for part in (model.encoder, model.decoder)
    )
    assert (encoder, decoder) == (19_583_232, 19_387_768)


def test_the_teaching_checkpoint_stays_below_one_and_a_half_megabytes():
    with torch.device("meta"):
        model = PQVAE(TEACHING_PQVAE)
        codes = model.encode(torch.zeros(2, 176, 288))
    assert codes.shape == (2, 22, 4)
    assert 2 * sum(v.numel() for v in model.state_dict().values()) < 1.5e6


@pytest.mark.parametrize(("quantizer", "groups"), [("product", 4), ("plain", 1), ("residual", 3)])
def test_every_quantiser_has_codes_of_its_groups(motion, quantizer, groups):
    model = PQVAE(replace(NARROW, quantizer=quantizer, groups=groups)).eval()
    codes = model.encode(motion)
    assert codes.shape == (3, 4, groups)
    made, quantized = model(motion)
    assert torch.equal(codes, quantized.codes)
    torch.testing.assert_close(model.decode(codes), made, atol=1e-5, rtol=1e-5)


def test_a_residual_stack_ends_in_a_plain_relu_and_adds_its_input():
    stack = ResidualStack(4, 3)
    assert sum(isinstance(m, torch.nn.Conv1d) for m in stack.modules()) == 3
    for parameter in stack.parameters():
        torch.nn.init.zeros_(parameter)
    x = torch.randn(2, 4, 9)
    assert torch.equal(stack(x), x.relu())


@pytest.mark.parametrize("convolution", [torch.nn.Conv1d, torch.nn.ConvTranspose1d])
def test_resampling_adds_a_bare_convolution_beside_the_normalised_one(convolution):
    resample = Resample(convolution, 4, 6).eval()
    x = torch.randn(2, 4, 8)
    expected = torch.nn.functional.leaky_relu(resample.main(x) + resample.beside(x), 0.2)
    assert torch.equal(resample(x), expected)
    assert expected.shape[-1] == (4 if convolution is torch.nn.Conv1d else 16)


def test_gradients_pass_the_quantiser_as_if_it_were_not_there(model, motion):
    latents = model.latents(motion).detach().requires_grad_()
    weights = torch.randn_like(latents)
    (model.quantizer(latents).vectors * weights).sum().backward()
    assert torch.equal(latents.grad, weights)


def test_the_encoder_learns_through_the_codes(model, motion):
    model(motion).motion.square().mean().backward()
    assert all(p.grad.abs().sum() > 0 for p in model.encoder[0].parameters())


def test_motion_moved_by_a_window_has_the_same_codes_moved_by_one(model):
    motion = torch.randn(1, 160, 376)
    model.eval()
    there, later = model.encode(motion[:, :152]), model.encode(motion[:, 8:])
    assert torch.equal(there[:, 9:10], later[:, 8:9])  # out of sight of both ends


@pytest.mark.parametrize("frames", [0, 7, 180])
def test_frames_that_are_no_whole_tokens_are_refused(model, frames):
    with pytest.raises(ValueError, match=f"8 frames, and {frames} are no multiple"):
        model.encode(torch.zeros(1, frames, 376))


def test_sizes_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match="multiples of 8 frames, got 180"):
        replace(PAPER_PQVAE, frames=180)
    with pytest.raises(ValueError, match="1 group, got groups=4"):
        replace(PAPER_PQVAE, quantizer="plain")
    with pytest.raises(ValueError, match=r"600 components .* 512 numbers"):
        replace(PAPER_PQVAE, straight=600)


def smooth_l1(x, beta=0.01):
    size = np.abs(x)
    return np.where(size < beta, x**2 / (2 * beta), size - beta / 2).mean()


def test_losses_are_those_of_the_authors_by_hand(model, motion):
    model.eval()
    with torch.no_grad():
        losses = pqvae_losses(model, motion)
        made, latents = model(motion).motion, model.latents(motion)
    off = (made - motion).numpy()
    spans = {"jaw": (0, 6), "body": (6, 96), "hands": (96, 276), "expression": (276, 376)}
    for name, (start, stop) in spans.items():
        assert float(getattr(losses, name)) == pytest.approx(smooth_l1(off[..., start:stop]))
    changes = np.abs(np.diff(off[..., :276], axis=1)).mean()
    assert float(losses.velocity) == pytest.approx(changes, rel=1e-5)
    nearest = model.quantizer.decode(model.encode(motion))
    commitment = (latents - nearest).square().mean()
    assert float(losses.commitment) == pytest.approx(float(commitment), rel=1e-4)
    seen = model.features
    apart = {
        "wrists": seen.wrists(made) - seen.wrists(motion),
        "movement": (seen.points(made) - seen.points(motion)).diff(dim=1),
    }
    for name, vectors in apart.items():
        assert float(getattr(losses, name)) == pytest.approx(
            float(vectors.norm(dim=-1).mean()), rel=1e-3
        )


def test_weights_of_the_losses_are_those_of_the_authors():
    losses = PQVAELosses(*torch.tensor([1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7]))
    assert float(losses.total()) == pytest.approx(0.1 * 1001 + 0.4 * 110 + 1e4 + 0.25e5)
    ours = float(losses.total(commitment=0.0, wrists=2.0, movement=3.0))
    assert ours == pytest.approx(0.1 * 1001 + 0.4 * 110 + 1e4 + 2e6 + 3e7)
    paper = PAPER_PQVAE
    assert (paper.commitment, paper.wrists, paper.movement) == (0.25, 0, 0)


def test_a_step_of_a_narrow_paper_model_moves_networks_and_codes(model, motion):
    before = {name: value.clone() for name, value in model.state_dict().items()}
    optimizer = torch.optim.Adam(model.parameters(), 1e-3)
    pqvae_losses(model, motion).total().backward()
    optimizer.step()
    moved = {n for n, v in model.state_dict().items() if not torch.equal(v, before[n])}
    assert {name for name, _ in model.named_parameters()} <= moved
    assert "quantizer.tables.vectors" in moved


def test_a_checkpoint_brings_statistics_codes_and_counters_back(model, motion, tmp_path):
    model.features.fit(0.3 * torch.randn(50, 55, 3), torch.randn(50, 100))
    pqvae_losses(model, motion)
    save_checkpoint(tmp_path / "pqvae.safetensors", model, NARROW)
    back = load_checkpoint(tmp_path / "pqvae.safetensors", PQVAE)
    assert back.config == NARROW
    for name, value in model.state_dict().items():
        assert torch.equal(back.state_dict()[name], value)
    assert torch.equal(back.encode(motion), model.eval().encode(motion))
