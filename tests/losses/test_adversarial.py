import pytest
import torch

from s2glib.losses import discriminator_loss, generator_loss


def test_a_perfect_judge_loses_nothing_and_a_blind_one_a_quarter():
    real, fake = torch.ones(2, 1, 3, 3), torch.zeros(2, 1, 3, 3)
    assert discriminator_loss(real, fake) == 0
    assert discriminator_loss(real / 2, fake + 0.5) == 0.25
    assert discriminator_loss(fake, real) == 1


def test_the_maker_wants_what_the_judge_calls_real():
    assert generator_loss(torch.ones(4)) == 0
    assert generator_loss(torch.zeros(4)) == 1


def test_the_best_answer_to_half_real_half_made_is_a_half():
    """LSGAN's optimum p_real / (p_real + p_made), found by descent on one score."""
    score = torch.zeros(1, requires_grad=True)
    for _ in range(100):
        (slope,) = torch.autograd.grad(discriminator_loss(score, score), score)
        score = (score - 0.2 * slope).detach().requires_grad_()
    assert float(score.detach()) == pytest.approx(0.5, abs=1e-6)


def test_gradients_are_those_of_finite_differences():
    scores = [torch.randn(3, dtype=torch.float64, requires_grad=True) for _ in range(2)]
    assert torch.autograd.gradcheck(discriminator_loss, scores)
    assert torch.autograd.gradcheck(generator_loss, scores[:1])
