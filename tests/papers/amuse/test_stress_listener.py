import torch

from s2glib.papers.amuse.stress_listener import (
    StressConfig,
    StressListener,
    heard_rhythm,
    stress_loss,
    stress_targets,
)


def test_a_target_is_one_at_each_stress_and_falls_off_on_both_sides():
    times = torch.tensor([[0.51, 1.01]])  # the middles of frames 25 and 50 at 50 frames a second
    target = stress_targets(times, 100, 50.0)[0]
    assert target[[25, 50]].tolist() == [1, 1]
    assert 0.8 < target[24] < 1
    torch.testing.assert_close(target[24], target[26])
    assert target[38] < 0.01


def test_missing_stresses_leave_no_mark():
    times = torch.tensor([[0.5, float("nan")], [float("nan"), float("nan")]])
    target = stress_targets(times, 50, 50.0)
    assert target[0].max() > 0.9
    assert target[1].max() == 0


def test_loudness_as_a_whole_does_not_matter():
    torch.manual_seed(0)
    listener, speech = StressListener(StressConfig()), torch.randn(2, 60, 64)
    torch.testing.assert_close(listener(speech), listener(speech + 3), atol=1e-5, rtol=1e-4)


def test_a_probability_per_frame():
    heard = StressListener(StressConfig())(torch.randn(3, 60, 64))
    assert heard.shape == (3, 60)
    assert heard.min() > 0
    assert heard.max() < 1


def test_the_listener_learns_a_click():
    torch.manual_seed(0)
    speech, target = torch.zeros(8, 60, 64), torch.zeros(8, 60)
    for row, place in enumerate(range(10, 50, 5)):
        speech[row, place] = 1.0
        target[row, place] = 1.0
    listener = StressListener(StressConfig())
    optimizer = torch.optim.Adam(listener.parameters(), 1e-2)
    for _ in range(40):
        optimizer.zero_grad()
        stress_loss(listener.logits(speech), target).backward()
        optimizer.step()
    assert listener(speech).argmax(dim=1).tolist() == list(range(10, 50, 5))


def test_rhythm_has_energy_onsets_and_stress():
    listener, speech = StressListener(StressConfig()), torch.randn(2, 60, 64)
    tracks = heard_rhythm(speech, listener)
    torch.testing.assert_close(tracks[..., 0], speech.mean(-1))
    torch.testing.assert_close(tracks[..., 2], listener(speech))
