# ---
# jupyter:
#   s2g: {"id": "00", "minutes": 15, "needs": [], "goals": ["check the set-up"], "data": ["shipped"], "budget_s": 25}
# ---

# %% [markdown]
# # Start here
#
# This workbook teaches how speech becomes gesture. You build three systems of 2024 in full:
#
# - **ProbTalk** turns motion into codes and predicts the missing ones.
# - **AMUSE** pulls speech apart into what is said, who says it and how it feels, and gestures from the parts.
# - **S2G-MDDiffusion** bends a picture so that the person in it gestures along.
#
# Every notebook runs on a laptop, without a network. Run a cell with Shift+Enter.

# %% [markdown]
# ## Does the set-up work?
#
# A tone of 440 Hz goes through the sound library. The spectrogram should be brightest at 440 Hz.

# %% tags=["s2g-setup"]
import ipywidgets
import librosa
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.folders import data_folder

sample_rate = 16000
tone = np.sin(2 * np.pi * 440 * np.arange(sample_rate) / sample_rate)

# %% tags=["s2g-figure"]
magnitude = np.abs(librosa.stft(tone, n_fft=1024))  # (frequencies, frames)
frequencies = librosa.fft_frequencies(sr=sample_rate, n_fft=1024)

figure, axes = plt.subplots(figsize=(6, 2.5), layout="constrained")
axes.pcolormesh(magnitude[:65])
axes.set(
    title="A tone of 440 Hz: one bright line",
    xlabel="frame",
    ylabel="frequency (Hz)",
    yticks=range(0, 65, 16),
    yticklabels=[f"{frequencies[row]:.0f}" for row in range(0, 65, 16)],
)
plt.show()

# %% [markdown]
# One bright line at 440 Hz, for the whole second.

# %%
loudest = frequencies[magnitude.mean(axis=1).argmax()]
learned = torch.ones(3, requires_grad=True)
learned.square().sum().backward()
verdicts = {
    "sound": abs(loudest - 440) < 16,
    "learning": torch.equal(learned.grad, torch.full((3,), 2.0)),
    "widgets": ipywidgets.IntSlider(7).value == 7,
    "the shipped data": data_folder().is_dir(),
}
for part, works in verdicts.items():
    print(f"{part}: {'works' if works else 'DOES NOT WORK'}")
print("the set-up works" if all(verdicts.values()) else "run `python3 workbook.py setup` again")
