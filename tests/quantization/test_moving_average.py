import copy

import pytest
import torch
from accelerate import Accelerator
from hypothesis import given
from hypothesis import strategies as st
from vector_quantize_pytorch import VectorQuantize

from s2glib.quantization import (
    ClusterTotals,
    Codebook,
    MovingAverage,
    ProductQuantizer,
    running_totals,
)

AS_PEER = MovingAverage(decay=0.8, bias_correction=False, revive_below=0)


def batches(count, *shape):
    generator = torch.Generator().manual_seed(0)
    return [torch.randn(shape, generator=generator) for _ in range(count)]


def trained(quantizer, data):
    for z in data:
        quantizer(z)
    return quantizer


def same_state(a, b):
    a, b = a.state_dict(), b.state_dict()
    return a.keys() == b.keys() and all(torch.equal(a[name], b[name]) for name in a)


def test_without_bias_correction_it_is_vector_quantize_pytorchs():
    torch.manual_seed(0)
    ours = ProductQuantizer(4, 16, 32, ema=AS_PEER)
    theirs = VectorQuantize(32, 16, 8, 4, separate_codebook_per_head=True, decay=0.8)
    theirs._codebook.embed.data = ours.codebooks.clone()
    theirs._codebook.embed_avg.data = ours.codebooks.clone()
    for z in batches(20, 6, 10, 32):
        _, codes, loss = theirs(z)
        mine = ours(z)
        assert torch.equal(mine.codes, codes)
        torch.testing.assert_close(mine.commitment_loss, loss)
        torch.testing.assert_close(ours.codebooks, theirs._codebook.embed)


@given(st.integers(1, 9), st.integers(1, 4), st.floats(0, 0.99))
def test_totals_are_those_of_a_loop_over_the_batch(n, count, decay):
    torch.manual_seed(n)
    z, codes = torch.randn(2, n, 3), torch.randint(count, (2, n))
    before = ClusterTotals(torch.rand(2, count), torch.randn(2, count, 3))
    sizes, sums = decay * before.sizes, decay * before.sums
    for group in range(2):
        for vector, code in zip(z[group], codes[group], strict=True):
            sizes[group, code] += 1 - decay
            sums[group, code] += (1 - decay) * vector
    after = running_totals(before, z, codes, decay)
    torch.testing.assert_close(after, ClusterTotals(sizes, sums))


@given(st.integers(1, 6), st.floats(0, 0.99))
def test_bias_correction_makes_it_a_weighted_mean_of_what_chose_the_code(steps, decay):
    """Written out: batch i counts decay^(steps - i); one code, so every vector chooses it."""
    codebook = Codebook(1, 2, ema=MovingAverage(decay)).double()
    data = [z.double() for z in batches(steps, 5, 2)]
    weights = torch.tensor([decay ** (steps - 1 - i) for i in range(steps)]).double()
    means = torch.stack([z.mean(0) for z in data])
    trained(codebook, data)
    torch.testing.assert_close(codebook.vectors[0], (weights @ means) / weights.sum())


def test_after_one_batch_codes_are_the_means_of_what_chose_them_as_in_lloyds_algorithm():
    torch.manual_seed(0)
    codebook = Codebook(4, 2, ema=MovingAverage(eps=1e-12, revive_below=0)).double()
    (z,) = batches(1, 200, 2)
    codes = codebook(z.double()).codes
    means = torch.stack([z[codes == code].mean(0) for code in range(4)]).double()
    torch.testing.assert_close(codebook.vectors, means)


def test_without_bias_correction_the_beginning_is_remembered():
    torch.manual_seed(0)
    plain = Codebook(1, 2, ema=MovingAverage(bias_correction=False)).double()
    start, (z,) = plain.vectors.clone(), batches(1, 5, 2)
    plain(z.double())
    expected = (0.99 * start + 0.01 * z.sum(0)) / (0.99 + 0.01 * 5)
    torch.testing.assert_close(plain.vectors, expected)


def test_smoothing_keeps_the_total_and_leaves_no_size_zero(make, z):
    means = trained(make(ema=MovingAverage(revive_below=0)), [z]).tables.means
    smoothed = means.smoothed_sizes()
    assert (smoothed > 0).all()
    total = torch.full((len(smoothed),), float(z[..., 0].numel()))
    torch.testing.assert_close(smoothed.sum(-1), total)


def test_a_dead_code_begins_again_at_a_vector_of_the_batch():
    torch.manual_seed(0)
    codebook = Codebook(8, 3, ema=MovingAverage(bias_correction=False))
    codebook.vectors[5:] = 1e3  # out of reach
    codebook.tables.means.sizes[0, 5:] = 0
    (z,) = batches(1, 64, 3)
    codebook(z)
    assert all((codebook.vectors[code] == z).all(-1).any() for code in (5, 6, 7))
    assert torch.equal(codebook.tables.means.sums[0, 5:], codebook.vectors[5:])
    assert codebook.tables.means.sizes[0, 5:].tolist() == [1, 1, 1]
    assert not any((codebook.vectors[code] == z).all(-1).any() for code in range(5))


def test_revival_brings_every_code_into_use():
    """Two clusters far from where all codes begin; without revival two codes take everything."""
    data = [z.sign() * 50 + z for z in batches(30, 128, 1)]
    used = {}
    for threshold in (0.0, 1.0):
        torch.manual_seed(0)
        codebook = trained(Codebook(16, 1, ema=MovingAverage(revive_below=threshold)), data)
        used[threshold] = len(codebook.encode(data[-1]).unique())
    assert used[0.0] <= 3
    assert used[1.0] >= 12


def test_fewer_vectors_than_codes_are_enough(make):
    quantizer = trained(make(ema=MovingAverage()), batches(5, 1, 6))
    assert quantizer.tables.vectors.isfinite().all()


def test_a_resume_from_the_state_dict_changes_nothing(make):
    data = batches(8, 20, 6)
    whole = trained(make(ema=MovingAverage()), data)
    torch.manual_seed(0)
    first = trained(make(ema=MovingAverage()), data[:3])
    torch.manual_seed(7)
    second = make(ema=MovingAverage())
    second.load_state_dict(copy.deepcopy(first.state_dict()))
    assert not same_state(whole, second)
    assert same_state(whole, trained(second, data[3:]))
    assert second.tables.means.step == 8


def test_a_resume_that_forgets_the_step_would_change_the_codes():
    """As the released code does: its counter is in no state dict  [authors' code]."""
    data, codebook = batches(4, 20, 6), Codebook(8, 6, ema=MovingAverage(revive_below=0))
    forgetful = copy.deepcopy(trained(codebook, data[:3]))
    forgetful.tables.means.step.zero_()
    assert not torch.allclose(
        trained(codebook, data[3:]).tables.means.smoothed_sizes(),
        trained(forgetful, data[3:]).tables.means.smoothed_sizes(),
    )


def test_in_evaluation_nothing_is_learned(make, z):
    quantizer = make(ema=MovingAverage()).eval()
    before = copy.deepcopy(quantizer)
    quantizer(z)
    assert same_state(before, quantizer)


def test_a_prepared_quantizer_learns_the_same_bits_every_time(make):
    """Under Accelerate, with an encoder in front that has something to train."""
    states = []
    for _ in range(2):
        torch.manual_seed(0)
        encoder, quantizer = torch.nn.Linear(6, 6), make(ema=MovingAverage())
        model = torch.nn.Sequential(encoder, quantizer)
        accelerator = Accelerator(cpu=True)
        prepared, optimizer = accelerator.prepare(model, torch.optim.Adam(encoder.parameters()))
        for z in batches(4, 20, 6):
            optimizer.zero_grad()
            accelerator.backward(prepared(z).commitment_loss)
            optimizer.step()
        states.append(model)
    assert same_state(*states)
    assert states[0][1].tables.means.step == 4


def test_two_processes_with_half_a_batch_each_learn_what_one_learns(make, monkeypatch):
    """The other process is played by a stand-in that has the same half."""
    (half,) = batches(1, 20, 6)
    rule = MovingAverage(revive_below=0)
    alone = trained(make(ema=rule), [torch.cat([half, half])])
    torch.manual_seed(0)
    shared = make(ema=rule)
    monkeypatch.setattr(torch.distributed, "is_initialized", lambda: True)
    monkeypatch.setattr(torch.distributed, "all_reduce", lambda total: total.mul_(2))
    monkeypatch.setattr(torch.distributed, "broadcast", lambda values, src: None)
    shared(half)
    torch.testing.assert_close(shared.state_dict(), alone.state_dict())


def test_a_group_of_one_process_changes_nothing(make, z):
    alone = trained(make(ema=MovingAverage()), [z])
    torch.manual_seed(0)
    shared = make(ema=MovingAverage())
    store = torch.distributed.HashStore()
    torch.distributed.init_process_group("gloo", store=store, rank=0, world_size=1)
    shared(z)
    torch.distributed.destroy_process_group()
    assert same_state(alone, shared)


@pytest.mark.parametrize(
    "bad", [{"decay": 1.0}, {"decay": -0.1}, {"eps": 0.0}, {"revive_below": -1.0}]
)
def test_a_rule_that_is_none_is_refused(bad):
    with pytest.raises(ValueError, match=r"authors' are 0\.99, 1e-5 and 1"):
        MovingAverage(**bad)
