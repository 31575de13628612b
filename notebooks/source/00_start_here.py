# ---
# jupyter:
#   s2g: {"id": "00", "minutes": 20, "needs": [], "goals": ["check the set-up", "swap the emotion of a gesture and say what changed", "find your way through the workbook"], "papers": {"AM": ["A", "Fig. A.4"]}, "demos": ["emotion swap"], "data": ["shipped"], "budget_s": 25, "exercises": [], "questions": ["00-q1", "00-p1", "00-p2", "00-q2"], "reached": {"check the set-up": ["00-q1"], "swap the emotion of a gesture and say what changed": ["emotion swap", "00-p1", "00-p2"], "find your way through the workbook": ["00-q2"]}}
# ---

# %% [markdown]
# # Start here: how does speech become gesture?
#
# | | |
# |---|---|
# | After this you can | check your set-up; swap the emotion of a gesture and say what changed; find your way through the workbook |
# | You need | nothing yet |
# | Time | 20 minutes |
# | Papers | an overview of all three; AMUSE A and Fig. A.4 |
# | Data | clips that come with the workbook |
#
# People move their hands when they speak. The words, the rhythm, the emotion and the person all show
# in the movement. Three papers of 2024 taught machines to do the same, each in its own way:
#
# - **ProbTalk** fills in the missing parts of a motion, face and hands included.
# - **AMUSE** splits speech into what is said, how it feels and who says it. Then it gestures from the parts.
# - **S2G-MDDiffusion** takes one picture of a person and makes it gesture.
#
# You will build all three. Everything runs on this computer, without the internet.
#
# **To run a cell, click it and press Shift+Enter.** Start with the next one.

# %% tags=["s2g-setup"]
from s2glib.teaching import PALETTE, ask, check_environment, figure, progress, report, setup

setup("00")

# %% [markdown]
# ## 1. Does your set-up work?
#
# The next cell tries each part once. A part that fails tells you how to mend it.

# %%
works = check_environment()

# %% [markdown]
# Now and then a question waits for you, like the next one. Run the cell and choose an answer: you are told
# why it is right, or what it overlooks. Choose again as often as you like.

# %%
ask("00-q1")

# %% [markdown]
# ## 2. Hear a sentence, see a body gesture it
#
# A *clip* is a sentence with its gestures. The name of this one says: sentence 4, voice 13, anger,
# take 2 (each sentence was spoken more than once).

# %%
from s2glib.corpus import SENTENCES
from s2glib.data import load_clip

clip = load_clip("s04-voice_13-anger-t2")
report(
    sentence=SENTENCES[clip.sentence].text,
    speaker=clip.speaker,
    emotion=clip.emotion,
    seconds=clip.motion.duration,
    frames_per_second=clip.motion.fps,
)

# %% [markdown]
# First as still pictures of one *stroke*, so that you see it without running anything. The body is
# our own *mannequin*.

# %% tags=["s2g-figure"]
import matplotlib.pyplot as plt

from s2glib.body import mannequin
from s2glib.viz import draw_bodies, draw_systems

body = mannequin()
moments = [0.5, 0.7, 0.8, 0.9, 1.0, 1.1]
fig, axes = plt.subplots(figsize=(9, 2.2))
draw_bodies(axes, clip.motion, body, moments)
figure(
    fig,
    "Six moments around the word 'never'. Watch the hands: they gather at the chest, "
    "strike outwards, and arrive.",
)

# %% [markdown]
# Now run the next cell and press **Play**. Drag to look around. The space bar plays and stops; the
# arrow keys step from frame to frame.

# %% tags=["s2g-media"]
from s2glib.widgets import Player, corpus_swap

player = Player(clip.motion, clip.waveform, body)
player

# %% [markdown]
# The sound is the clock: the body shows the frame that belongs to what you hear. Play it at a slower
# speed and look for this: *the hands arrive when a stressed syllable begins.* Notebook 01 measures it.
#
# ## 3. Swap the emotion
#
# What you just saw came from the corpus. From here on a trained network gestures: our small version
# of **AMUSE**. It works in two steps.
#
# 1. It *hears* the sound and writes down three lists of numbers, its *latents*: content (what is said),
#    emotion (how it feels) and style (who says it).
# 2. It starts from random numbers, called *noise*, and turns them, step by step, into a motion that
#    fits the latents.
#
# So an emotion can be swapped: keep content and style, put in the latent of another emotion, averaged
# over clips of that emotion, and do step 2 again *from the same noise*. So any difference comes from
# the swap.

# %%
import torch

from s2glib.corpus import EMOTIONS
from s2glib.folders import data_folder
from s2glib.papers.amuse import Amuse

amuse = Amuse.load(data_folder() / "checkpoints")


def gesture(heard, start=0):
    """A motion for what was heard; the same start gives the same noise."""
    return amuse.gesture(heard, generator=torch.Generator().manual_seed(start))


def swap(heard, emotion):
    """The same speech with the mean latent of another emotion."""
    return heard.with_emotion(amuse.emotion_centre(EMOTIONS.index(emotion)))


heard = amuse.hear(clip.waveform)
sad = swap(heard, "sadness")
report(
    content_is_kept=torch.equal(sad.latents.content, heard.latents.content),
    style_is_kept=torch.equal(sad.latents.style, heard.latents.style),
    emotion_is_kept=torch.equal(sad.latents.emotion, heard.latents.emotion),
    same_noise_gives_the_same_motion=torch.equal(gesture(sad).poses, gesture(sad).poses),
)

# %% [markdown]
# Only the emotion latent differs. Does the motion follow? **Predict first**, then run the cell below.

# %%
ask("00-p1")

# %% tags=["s2g-figure"]
fig, rows = plt.subplots(2, 1, figsize=(9, 4.2), sharex=True)
moments = [0.5, 1.3, 2.1, 2.9, 3.7, 4.5]
for axes, motion, title in (
    (rows[0], gesture(heard), "as it was said: anger"),
    (rows[1], gesture(sad), "emotion swapped: sadness"),
):
    draw_bodies(axes, motion, body, moments)
    axes.set(title=title, xlabel="")
rows[1].set(xlabel="time (s)")
figure(
    fig,
    "One sound, two motions from the same noise. "
    "Compare the height of the hands, the shoulders and the head.",
    exact=False,
)

# %% [markdown]
# The demo does this for every sentence, voice and emotion of the corpus. Choose in the lists, then
# press Play. **true target** shows how the corpus itself speaks and gestures the sentence in the new
# emotion.

# %% tags=["s2g-demo"]
demo = corpus_swap(amuse, body)
demo.sentence.value, demo.speaker.value = clip.sentence, clip.speaker
demo.emotion.value, demo.new_emotion.value = "anger", "sadness"
demo

# %% [markdown]
# Three things to try:
#
# <details><summary>1. Side by side, anger becomes sadness. What changes, and what does not?</summary>
#
# Posture, hands and brows change; the next section measures how much. Both bodies follow one sound, so
# both take the same time, and their mouths say the same words.
# </details>
#
# <details><summary>2. Press "true target". Why does it sound different?</summary>
#
# A sad speaker is slower and softer. A swap edits the body only: it never touches the sound. So the
# target has its own sound and its own clock.
# </details>
#
# <details><summary>3. Compare the true targets of contempt and disgust. Then look at the swaps.</summary>
#
# Their hands move almost equally fast. Contempt lifts the chin; disgust lowers it and raises the
# shoulders. They tilt to opposite sides. Do the swaps show it as clearly? What a network finds easy is not
# always what you find telling.
# </details>

# %% [markdown]
# ## 4. Do not trust your eyes: measure
#
# A first number: how fast do the wrists move, on average? One clip tells little, because people and
# sentences differ and noise moves a body, too. So here are two sentences of four voices: as the corpus
# gestures them in eight emotions, and the swaps of the same sentences spoken in anger.

# %%
ask("00-p2")

# %% tags=["s2g-figure"]
from s2glib.body import joint, joint_positions

wrists = [joint("left_wrist"), joint("right_wrist")]


def wrist_speed(motion):
    """Mean speed of both wrists in metres per second."""
    steps = joint_positions(motion, body)[:, wrists].diff(dim=0).norm(dim=-1)
    return steps.mean().item() * motion.fps


voices = ["voice_01", "voice_03", "voice_05", "voice_13"]
spoken = [f"{sentence}-{voice}" for sentence in ("s01", "s04") for voice in voices]


def from_corpus(who, emotion):
    return load_clip(f"{who}-{emotion}-t2")


angry = [amuse.hear(from_corpus(who, "anger").waveform) for who in spoken]
real = {e: [from_corpus(who, e).motion for who in spoken] for e in EMOTIONS}
swaps = {e: [gesture(swap(speech, e)) for speech in angry] for e in EMOTIONS}
true = {e: sum(map(wrist_speed, real[e])) / len(spoken) for e in EMOTIONS}
edited = {e: sum(map(wrist_speed, swaps[e])) / len(spoken) for e in EMOTIONS}

fig, axes = plt.subplots(figsize=(7, 3.6))
for e, motions in swaps.items():
    speeds = [wrist_speed(motion) for motion in motions]
    axes.plot(speeds, [e] * len(speeds), ".", color=PALETTE["vermilion"], alpha=0.4)
axes.plot(list(true.values()), EMOTIONS, "o", color=PALETTE["blue"], label="corpus, mean")
axes.plot(list(edited.values()), EMOTIONS, "s", color=PALETTE["vermilion"], label="swaps, mean")
axes.set(xlabel="mean wrist speed (m/s)", ylabel="emotion", xlim=(0, None))
axes.invert_yaxis()
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
figure(
    fig,
    "Wrist speed by emotion; small dots are single swaps. Sadness is slow in the corpus and after "
    "swaps. Look also where the two disagree, and how wide the dots spread.",
    exact=False,
)

# %%
from scipy.stats import spearmanr

shoulders = [joint("left_shoulder"), joint("right_shoulder")]


def drop(motion):
    """Mean height of the shoulders above the wrists in metres."""
    heights = joint_positions(motion, body)[..., 1]
    return (heights[:, shoulders] - heights[:, wrists]).mean().item()


def order_kept(measure):
    """Rank correlation over the emotions, corpus against swaps."""
    means = [[sum(map(measure, some[e])) for e in EMOTIONS] for some in (real, swaps)]
    return spearmanr(*means).statistic


report(
    furthest_from_the_corpus=max(EMOTIONS, key=lambda e: abs(edited[e] / true[e] - 1)),
    hands_hang_below_the_shoulders=all(
        drop(motion) > 0 for motions in swaps.values() for motion in motions
    ),
    every_sad_swap_is_slower_than_its_angry_one=all(
        wrist_speed(sad) < wrist_speed(cross)
        for sad, cross in zip(swaps["sadness"], swaps["anger"], strict=True)
    ),
    order_of_speeds_is_kept_somewhat=order_kept(wrist_speed) > 0.3,
    order_of_hand_heights_is_kept=order_kept(drop) > 0.6,
)

# %% [markdown]
# Each line could have come out otherwise. *Rank correlation* compares two orders, say from slow to fast: 1
# means the same order, 0 no relation. Where the hands are held survives the swap better than how fast they
# go: only the emotion latent was swapped, and the words and the rhythm still sound angry.
#
# One number is not an emotion, of course: speed also depends on the person and the sentence.
# Notebooks 14 and 17 ask the harder question: does a *judge*, a second network that names the
# emotion, recognise the new one?
#
# ## 5. The map
#
# All three systems turn speech into motion, and all three generate something smaller than motion
# first. The numbers are the notebooks where you build each step.

# %% tags=["s2g-figure"]
fig, axes = plt.subplots(figsize=(11, 5.2))
draw_systems(axes)
figure(
    fig,
    "The three systems, one a row; below each step, the notebooks that build it. "
    "They differ most in the second column: codes, separated latents, or keypoints.",
)

# %%
ask("00-q2")

# %% [markdown]
# The next cell tells how far you have come. Run it again whenever you are back.

# %% tags=["s2g-progress", "nbval-ignore-output"]
progress()

# %% [markdown]
# ## 6. One letter, three meanings
#
# Each paper has its own alphabet. Our code uses words for things (`emotion`, `frames`) and a paper's
# letter only for matrices. When a formula puzzles you, look here first.
#
# <details><summary>The letters</summary>
#
# | letter | in ProbTalk | in AMUSE | in S2G-MDDiffusion |
# |---|---|---|---|
# | $A$, $a$ | the audio | a recording | $A$ an affine map, $\mathbf{a}$ audio features |
# | $c$ | | content latent | the condition: audio and a first frame |
# | $D$ | speaker identity | decoder of speech | $\mathbf{D}$ the driving image |
# | $E$ | | encoders $E_c, E_e, E_s$ | keypoint predictor, image encoder, expectation |
# | $I$ | mask of known frames | | $\mathbf{I}$ the identity matrix |
# | $K$ | | | number of warps *and* a matrix of the spline |
# | $M$ | a motion | the feature extractor | number of frames |
# | $N$ | number of frames | | number of keypoints per warp |
# | $P$ | | the motion prior, $\mathcal{P}$ | number of candidates *and* a matrix of the spline |
# | $s$, $S$ | | style latent | $\mathbf{S}$ the source image |
# | $T$ | | number of frames | number of noise levels; $\mathcal{T}$ a warp |
# | $w$ | frames behind one code | | weights of the spline |
# | $\Delta$ | | the denoiser | the Laplace operator |
# </details>
#
# ## 7. How these notebooks work
#
# - **Run cells from top to bottom.** Lost? *Kernel > Restart Kernel and Run All Cells* starts afresh.
# - **Change things.** Another clip, another number: nothing breaks.
#   `git checkout notebooks/00_start_here.ipynb` restores this one; your changes in it are lost.
# - **Exercises check themselves.** While yours is not right yet, the notebook goes on with the package's
#   function, so you can always read on.
# - **Every figure has a caption** that says what to look for. Where the numbers are the same on every
#   machine, a line below tells the extent of its axes.
#
# ## 8. What this is not
#
# - Nobody was recorded. A program speaks and gestures all clips. In return their factors (sentence,
#   voice, emotion) are *known*, so that we can check what the papers could only claim.
# - The voices are synthetic, and so are the emotions: eight recipes, far simpler than people.
# - The networks are small and were trained on that corpus alone. With a real voice they give *a*
#   motion; do not expect a good one.
# - A gesture says something about a person. Notebook 21 is about what may go wrong with that.
#
# **Next:** [01 Motion and sound](01_motion_and_sound.ipynb), where you take a clip apart, down to the numbers.
