import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.distributions import Normal, kl_divergence

from s2glib.losses import kl_to_standard_normal

numbers = st.floats(-6, 6)


@given(mean=numbers, log_var=numbers)
def test_the_divergence_is_that_of_torch_distributions(mean, log_var):
    m, v = (torch.tensor([value], dtype=torch.float64) for value in (mean, log_var))
    oracle = kl_divergence(Normal(m, (v / 2).exp()), Normal(0.0, 1.0))
    torch.testing.assert_close(kl_to_standard_normal(m, v), oracle, rtol=1e-9, atol=1e-12)


@given(mean=numbers, log_var=numbers)
def test_only_the_standard_normal_is_free(mean, log_var):
    m, v = (torch.tensor(value, dtype=torch.float64) for value in (mean, log_var))
    assert kl_to_standard_normal(m, v) >= 0
    assert kl_to_standard_normal(0 * m, 0 * v) == 0


def test_each_element_has_its_own_price_so_both_reductions_are_one_call():
    mean = torch.tensor([[[1.0, 2.0], [3.0, 0.0]]])
    kl = kl_to_standard_normal(mean, torch.zeros_like(mean))
    assert kl.tolist() == [[[0.5, 2.0], [4.5, 0.0]]]
    assert kl.sum((-2, -1)).mean() == kl.mean() * 4


def test_gradients_are_those_of_finite_differences():
    inputs = [torch.tensor([-1.0, 0.5], dtype=torch.float64, requires_grad=True) for _ in "mv"]
    assert torch.autograd.gradcheck(kl_to_standard_normal, inputs)
