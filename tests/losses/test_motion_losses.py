import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.losses import acceleration_loss, velocity_loss

BOTH = pytest.mark.parametrize(("loss", "order"), [(velocity_loss, 1), (acceleration_loss, 2)])


def motion(*shape, seed=0):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


def printed(x, x_hat, order):
    """[MDD Eqs. B13-B14] with their sums and indices, for one motion (M, channels)."""
    M, total = len(x), 0.0
    for m in range(M - order):
        if order == 1:
            change, change_hat = x[m + 1] - x[m], x_hat[m + 1] - x_hat[m]
        else:
            change = (x[m + 2] - x[m + 1]) - (x[m + 1] - x[m])
            change_hat = (x_hat[m + 2] - x_hat[m + 1]) - (x_hat[m + 1] - x_hat[m])
        total += torch.linalg.norm(change - change_hat).item() ** 2
    return total / (M - order)


@BOTH
@given(frames=st.integers(3, 9), channels=st.integers(1, 5))
def test_the_loss_is_the_printed_sum_over_the_channels(loss, order, frames, channels):
    x, x_hat = motion(frames, channels), motion(frames, channels, seed=1)
    assert loss(x, x_hat).item() * channels == pytest.approx(printed(x, x_hat, order))


@BOTH
def test_a_batch_has_the_mean_loss_of_its_motions(loss, order):
    x, x_hat = motion(2, 3, 8, 4), motion(2, 3, 8, 4, seed=1)
    each = [loss(a, b) for a, b in zip(x.flatten(0, 1), x_hat.flatten(0, 1), strict=True)]
    torch.testing.assert_close(loss(x, x_hat), torch.stack(each).mean())


def test_a_shift_has_no_velocity_and_a_drift_no_acceleration():
    x, drift = motion(8, 4), torch.arange(8.0, dtype=torch.float64)[:, None]
    assert velocity_loss(x, x + 3).item() == pytest.approx(0, abs=1e-12)
    assert velocity_loss(x, x + 3 * drift).item() == pytest.approx(9)
    assert acceleration_loss(x, x + 3 * drift).item() == pytest.approx(0, abs=1e-12)
    assert acceleration_loss(x, x + drift**2).item() == pytest.approx(4)


@BOTH
def test_gradients_are_those_of_finite_differences(loss, order):
    x, x_hat = motion(5, 2).requires_grad_(), motion(5, 2, seed=1).requires_grad_()
    assert torch.autograd.gradcheck(loss, (x, x_hat))


@BOTH
def test_too_few_frames_are_refused(loss, order):
    with pytest.raises(ValueError, match=f"more than {order} frames"):
        loss(motion(order, 4), motion(order, 4))


@BOTH
def test_an_empty_batch_is_refused(loss, order):
    with pytest.raises(ValueError, match="expected two motions"):
        loss(motion(0, 8, 4), motion(0, 8, 4))
