"""Sounds whose content is known: clicks at known times, a vowel of known pitch."""

import numpy as np
import pytest

RATE = 16000


def click_train(times, duration, sample_rate):
    """Decaying bursts of noise that begin at the given seconds."""
    samples = np.zeros(int(duration * sample_rate), np.float32)
    burst = np.arange(int(0.05 * sample_rate)) / sample_rate
    noise = np.random.default_rng(0).standard_normal(len(burst))
    for time in times:
        start = round(time * sample_rate)
        samples[start : start + len(burst)] += 0.3 * noise * np.exp(-burst / 0.01)
    return samples


@pytest.fixture(scope="session")
def click_seconds():
    return 0.3 + 0.37 * np.arange(10)


@pytest.fixture(scope="session")
def clicks(click_seconds):
    return click_train(click_seconds, duration=4.2, sample_rate=RATE)


@pytest.fixture(scope="session")
def vowel():
    """3.2 s of an A (220 Hz, eight harmonics) that swells and fades."""
    t = np.arange(int(3.2 * RATE)) / RATE
    harmonics = sum(np.sin(2 * np.pi * 220 * k * t) / k for k in range(1, 9))
    return (0.2 * harmonics * np.sin(np.pi * t / 3.2) ** 2).astype(np.float32)
