# ---
# jupyter:
#   s2g: {"id": "01", "minutes": 75, "needs": ["00"], "goals": ["describe a clip as arrays on one clock", "turn joint angles into places and into a surface", "compute the sound features that the papers use", "line up frames and hops", "say why meshes need more than a skeleton file"], "papers": {"MDD": ["B.5"], "AM": ["B.5", "C.2", "Fig. A.8", "F", "G"], "PT": ["A.2"]}, "demos": ["player", "toy arm"], "data": ["shipped"], "budget_s": 25, "exercises": ["01-1", "01-2", "01-3"], "questions": ["01-p1", "01-p2", "01-p3", "01-p4", "01-p5", "01-q1", "01-q2", "01-q3", "01-q4", "01-q5"], "reached": {"describe a clip as arrays on one clock": ["player", "01-q1", "01-q3"], "turn joint angles into places and into a surface": ["01-1", "01-2", "toy arm", "01-p2"], "compute the sound features that the papers use": ["01-p3", "01-p4"], "line up frames and hops": ["01-3", "01-q4"], "say why meshes need more than a skeleton file": ["01-q2", "01-q3"]}}
# ---

# %% [markdown]
# # Motion and sound: what does the computer see and hear?
#
# | | |
# |---|---|
# | After this you can | describe a clip as arrays on one clock; turn joint angles into places and into a surface; compute the sound features that the papers use; line up frames and hops; say why meshes need more than a skeleton file |
# | You need | [00 Start here](00_start_here.ipynb) |
# | Time | 40 minutes, and 35 for the exercises |
# | Papers | MDD B.5; AMUSE B.5, C.2, Fig. A.8, F, G; ProbTalk A.2 |
# | Data | clips that come with the workbook |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("01")

# %% [markdown]
# ## 1. One clip, one clock
#
# A clip is two streams that share one clock: motion in *frames*, sound in *samples*.

# %%
from s2glib.body import mannequin
from s2glib.data import load_clip

clip = load_clip("s04-voice_13-anger-t2")
motion, sound = clip.motion, clip.waveform
body = mannequin()
report(
    poses=motion.poses.shape,
    place_of_the_pelvis=motion.trans.shape,
    face=motion.expression.shape,
    frames_per_second=motion.fps,
    samples=len(sound.samples),
    samples_per_second=sound.sample_rate,
    seconds_of_motion=motion.duration,
    seconds_of_sound=len(sound.samples) / sound.sample_rate,
)

# %% [markdown]
# Read the first line as *frames x joints x 3*: in every frame each of 55 joints has three numbers
# that say how it is turned. These are the joints of **SMPL-X**, the body that ProbTalk and AMUSE
# use: 22 in the body, 3 for jaw and eyes, 2 x 15 in the hands. The face has 100 numbers for the
# expression. Sound has far more samples than motion has
# frames, but both last equally long. (The motion stops at the last whole frame.)

# %% tags=["s2g-figure"]
from s2glib.viz import draw_bodies, draw_features, draw_pose, draw_waveform, draw_words

words = [word.name for word in clip.words], [word.start for word in clip.words]
fig, (top, bottom) = plt.subplots(2, 1, figsize=(9, 4.6), height_ratios=[2, 1])
draw_bodies(top, motion, body, [0.5, 1.3, 2.1, 2.9, 3.7, 4.5])
draw_words(draw_waveform(bottom, sound.samples, sound.sample_rate), *words)
figure(
    fig,
    "Above, the body at six moments; below, the sound and its words. "
    "Find the word that belongs to each pose.",
)

# %% tags=["s2g-media"]
from s2glib.widgets import Player, ToyArm

player = Player(motion, sound, body)
player

# %% [markdown]
# Drag the time slider below the body: you *scrub* through the frames.
#
# ## 2. One turn, three ways to write it
#
# A body moves by turning its joints. There are three common ways to write down a turn:
#
# - **axis-angle**, 3 numbers: the axis, as long as the angle in radians;
# - **matrix**, 9 numbers: where the x, y and z directions go, one in each column;
# - **6D**, 6 numbers: the first two rows of the matrix, one after the other.
#
# Check one by hand: a quarter turn about the z axis takes x to y.

# %%
from s2glib.body import axis_angle_to_matrix, matrix_to_axis_angle, matrix_to_sixd

quarter = torch.tensor([0, 0, np.pi / 2], dtype=torch.float64)
matrix = axis_angle_to_matrix(quarter)
report(
    axis_angle=quarter,
    matrix=matrix,
    sixd=matrix_to_sixd(matrix),
    x_goes_to=matrix @ torch.tensor([1, 0, 0], dtype=torch.float64),
)

# %% [markdown]
# Why write six numbers where three would do? Because a network finds it hard to jump. Let a joint turn
# steadily, one degree a step, all the way round. The body moves smoothly, so its numbers should, too.
# **Predict first**, then run the cell below.

# %%
ask("01-p1")

# %% tags=["s2g-figure"]
degrees = torch.arange(361, dtype=torch.float64)
turning = axis_angle_to_matrix(degrees.deg2rad()[:, None] * torch.tensor([0.0, 0.0, 1.0]))
forms = {"axis-angle": matrix_to_axis_angle(turning), "6D": matrix_to_sixd(turning)}

fig, panels = plt.subplots(1, 2, figsize=(10, 3), sharex=True)
for axes, (name, numbers) in zip(panels, forms.items(), strict=True):
    labels = [f"row {row}: {axis}" for row in (1, 2) for axis in "xyz"] if name == "6D" else "xyz"
    axes.plot(degrees, numbers, label=list(labels))
    axes.set(title=name, xlabel="turn (degrees)", ylabel="value")
    axes.legend(fontsize=9, loc="upper left", bbox_to_anchor=(1, 1))
figure(
    fig,
    "One steady turn. At 180 degrees axis-angle jumps from +pi to -pi; "
    "the six numbers never jump. (Two pairs of the six lie on each other.)",
)
steps = {name: numbers.diff(dim=0).abs().max() for name, numbers in forms.items()}
report(**{f"largest step of {name}": step for name, step in steps.items()})

# %% [markdown]
# The second reason: *any* six numbers can be made into a turn, so a network may say what it likes.
#
# ### Exercise 01-1: six numbers make a turn
#
# ●○○ · 8 minutes · [PT A.2, AM C.2]
#
# Bring the first three numbers to length 1: that is the first row, $b_1$. From the last three take away
# what points along $b_1$; bring the rest to length 1: that is $b_2$. The third row is square to both,
# $b_3 = b_1 \times b_2$.
#
# Write your code in place of the dots. Run the cell, and the next one to check it. You may also skip an
# exercise: the notebook then goes on with the package's function.


# %% tags=["s2g-exercise"]
def sixd_to_matrix(sixd):
    """Make turns from any numbers, (n, 6) to (n, 3, 3)."""
    ...  # your code


# %% tags=["s2g-solution"]
def sixd_to_matrix(sixd):
    """Make turns from any numbers, (n, 6) to (n, 3, 3)."""
    a1, a2 = sixd[:, :3], sixd[:, 3:]
    b1 = a1 / a1.norm(dim=-1, keepdim=True)
    rest = a2 - (b1 * a2).sum(-1, keepdim=True) * b1
    b2 = rest / rest.norm(dim=-1, keepdim=True)
    return torch.stack([b1, b2, torch.linalg.cross(b1, b2)], dim=-2)


# %% tags=["s2g-check", "nbval-ignore-output"]
sixd_to_matrix = check("01-1", sixd_to_matrix)

# %% [markdown]
# Stuck? Click on a hint. The solution is the package's own code.

# %% tags=["s2g-source"]
show_solution("01-1")

# %%
anything = torch.randn(1000, 6, dtype=torch.float64)
made = sixd_to_matrix(anything)
square = (made @ made.mT - torch.eye(3)).abs().max()
report(
    rows_are_square_to_each_other=(square < 1e-9).item(),
    nothing_is_mirrored=bool((torch.linalg.det(made) > 0).all()),
)

# %% [markdown]
# **Trap.** The paper that proposed 6D (Zhou et al., *On the Continuity of Rotation Representations in
# Neural Networks*, 2019) keeps two *columns*. The code of ProbTalk and AMUSE keeps two
# *rows*. Mix them up, and every joint turns backwards.
#
# ## 3. From turns to places
#
# Angles do not tell where a hand is. **Forward kinematics** does: walk from the root to the finger
# tips, and at every joint add one bone. Joint $j$ hangs on its parent $p$ by an offset $o_j$, and turns
# by $R_j$:
#
# $$G_j = G_p R_j, \qquad x_j = x_p + G_p\, o_j$$
#
# $G_j$ is the turn of a joint as seen by the whole body, $x_j$ its place. The offset is
# $o_j = t_j - t_p$, where $t_j$ is the place at rest; the root keeps its own turn and place ($G_0 = R_0$).
#
# **Predict first**, with pencil and paper.

# %%
ask("01-p2")

# %% [markdown]
# ### Exercise 01-2: walk along the bones
#
# ●●○ · 10 minutes · [PT A.2, AM C.2]
#
# Now let the computer walk, along any tree of joints. Joint 0 is the root, and its parent is -1. Every
# other joint comes after its parent, so a parent's $G_p$ and $x_p$ are known when you need them.


# %% tags=["s2g-exercise"]
def forward_kinematics(rotations, rest_joints, parents):
    """Return G (joints, 3, 3) and x (joints, 3).

    rotations: R of each joint, (joints, 3, 3)
    rest_joints: t, its place at rest, (joints, 3)
    parents: p, one whole number for each joint
    """
    ...  # your code


# %% tags=["s2g-solution"]
def forward_kinematics(rotations, rest_joints, parents):
    """Return G (joints, 3, 3) and x (joints, 3)."""
    G, x = [rotations[0]], [rest_joints[0]]
    for j in range(1, len(parents)):
        p = parents[j]
        offset = rest_joints[j] - rest_joints[p]
        G.append(G[p] @ rotations[j])
        x.append(x[p] + G[p] @ offset)
    return torch.stack(G), torch.stack(x)


# %% tags=["s2g-check", "nbval-ignore-output"]
forward_kinematics = check("01-2", forward_kinematics)

# %% tags=["s2g-source"]
show_solution("01-2")

# %% [markdown]
# Our own code keeps $G_j$ and $x_j$ in one matrix of 4 x 4, so that one product does both formulas. Does
# the walk find the hand where you put it?

# %%
rest = torch.tensor([[0.0, 0, 0], [0.30, 0, 0], [0.55, 0, 0]], dtype=torch.float64)
turns = torch.stack([quarter, quarter, torch.zeros_like(quarter)])
G, x = forward_kinematics(axis_angle_to_matrix(turns), rest, parents=(-1, 0, 1))
report(elbow=x[1], hand=x[2])

# %% [markdown]
# Play with it: five settings, five pictures.

# %% tags=["s2g-selftest"]
toy = ToyArm()
toy.selftest()
toy.strip([{}, {"shoulder": 90}, {"elbow": 90}, {"shoulder": 90, "elbow": 90}])

# %% tags=["s2g-demo"]
toy

# %% [markdown]
# Elbow 90 puts the hand at (0.30, 0.25). Now set the elbow to -90, and bring the hand back with the
# shoulder: at 75 it is almost there. Two poses, one place: the hand's place does not tell the pose. Even
# all joints' places leave out how a bone twists about its length. So ProbTalk and AMUSE work on angles.
#
# The body is the same walk over 55 joints:

# %% tags=["s2g-figure"]
from s2glib.body import joint, joint_positions

places = joint_positions(motion, body).numpy()  # (frames, 55, 3) metres
wrist = places[:, joint("right_wrist")]
fig, views = plt.subplots(1, 2, figsize=(8, 3.6), sharey=True)
for axes, view, axis in zip(views, ("front", "side"), (0, 2), strict=True):
    draw_pose(axes, places[45], view=view)
    axes.plot(wrist[:, axis], wrist[:, 1], color=PALETTE["green"], linewidth=1)
    title = {"front": "front", "side": "side; the body faces right"}[view]
    axes.set(title=title, xlabel="xyz"[axis] + " (m)", ylabel="y (m)", aspect="equal")
    axes.set(xlim=(-0.7, 0.7), ylim=(0.85, 1.75))
figure(
    fig,
    "The skeleton at 1.5 s; the body's left is blue, its right vermilion. "
    "The green line is the path of the right wrist through the whole clip.",
)

# %% [markdown]
# S2G-MDDiffusion, **MDD** from here on, works on pictures, so it never sees the third number. Its
# *keypoints*, marks that follow the parts of a picture, have x and y only, and it learns by itself where
# to put them (notebook 03).
#
# ## 4. From places to a surface
#
# A body is more than bones. **Linear blend skinning** lets each point $v$ of the surface follow several
# joints, by weights $w_{vj}$ that sum to one. With $t_j$ its place at rest:
#
# $$v' = \sum_j w_{vj}\,\bigl(G_j (v - t_j) + x_j\bigr)$$
#
# In words: seen from each joint, turn the point with the joint; then mix what the joints say. The
# formula is two lines of code. The package does the same, in an order that saves memory:

# %%
from s2glib.body import linear_blend_skinning

rotations = axis_angle_to_matrix(motion.poses[45])
G, x = forward_kinematics(rotations, body.joints, body.parents)
from_joint = body.vertices[:, None] - body.joints  # (v, j, 3): v - t_j
says = torch.einsum("jab,vjb->vja", G, from_joint) + x  # what each joint says
surface = torch.einsum("vj,vja->va", body.weights, says)

skinned = linear_blend_skinning(body, rotations, torch.zeros(3))
report(
    surface_points=len(body.vertices),
    weights_sum_to_one=torch.allclose(body.weights.sum(1), torch.ones(len(body.vertices))),
    formula_equals_package=torch.allclose(surface, skinned.vertices, atol=1e-5),
)

# %% [markdown]
# **Break it.** What if each point follows its strongest joint only?

# %% tags=["s2g-figure"]
from dataclasses import replace

from s2glib.body import PELVIS_HEIGHT, Motion

hard = torch.nn.functional.one_hot(body.weights.argmax(1), 55).float()
bent = torch.zeros(1, 55, 3)
bent[0, [joint("left_shoulder"), joint("left_elbow")], 2] = torch.tensor([-0.7, 2.2])
pose = Motion(bent, torch.tensor([[0.0, PELVIS_HEIGHT, 0.0]]), torch.zeros(1, 100), 30)

fig, panels = plt.subplots(1, 2, figsize=(8, 3), sharey=True)
for axes, weights, title in zip(panels, (body.weights, hard), ("blended", "hard"), strict=True):
    draw_bodies(axes, pose, replace(body, weights=weights), [0.0])
    axes.set(title=title, xlim=(0.1, 0.6), ylim=(1.1, 1.5), xlabel="x (m)")
    axes.set_xticks([0.2, 0.4, 0.6], ["0.2", "0.4", "0.6"])
figure(
    fig,
    "A bent left arm from the front. Look at the elbow: blended weights give a round bend, "
    "hard weights an edge where the two halves of the sleeve collide.",
)

# %% [markdown]
# Hard weights make two stiff tubes; blended weights bend the skin.
#
# ## 5. Why a mesh needs more than a skeleton file
#
# Motion capture often comes as **BVH**: a text file with bone lengths and one line of angles a frame.
# A **GLB** file holds the surface as well; any 3-D viewer opens it.

# %%
import tempfile
from pathlib import Path

from s2glib.body import read_bvh, skin_motion, write_bvh, write_glb

folder = Path(tempfile.mkdtemp())
write_bvh(folder / "clip.bvh", motion, body)
write_glb(folder / "clip.glb", motion, body)
lines = (folder / "clip.bvh").read_text().splitlines()
print("\n".join(lines[:8]))
report(
    lines_of_skeleton=lines.index("MOTION"),
    lines_of_angles=len(lines) - lines.index("MOTION") - 3,
    joints_read_back=len(read_bvh(folder / "clip.bvh").names),
    lines_about_the_surface=sum("vert" in line.lower() for line in lines),
)

# %% [markdown]
# BVH has no skin, no weights, no girth. So it cannot know whether a hand touches the belly. Give two
# bodies the very same angles:

# %% tags=["s2g-figure"]
trunk = body.weights[:, [joint(name) for name in ("pelvis", "spine1", "spine2", "spine3")]].sum(1)
wider = 1 + 0.4 * trunk[:, None] * torch.tensor([1.0, 0.0, 1.0])
stout = replace(body, vertices=body.vertices * wider)


def gap(person):
    """Metres from the left wrist to the nearest point of the trunk, frame by frame."""
    skinned = skin_motion(motion, person)
    hand = skinned.joints[:, [joint("left_wrist")]]
    return torch.cdist(hand, skinned.vertices[:, trunk > 0.6]).amin(dim=(1, 2))


people = {"slim": body, "stout": stout}
gaps = {name: gap(person).numpy() for name, person in people.items()}
closest = gaps["slim"].argmin() / motion.fps
fig, (*pictures, plot) = plt.subplots(1, 3, figsize=(10, 3), width_ratios=[1, 1, 2])
for axes, (name, person) in zip(pictures, people.items(), strict=True):
    draw_bodies(axes, motion, person, [closest], turn=0.7)
    axes.set_title(name)
    plot.plot(np.arange(motion.frames) / motion.fps, 100 * gaps[name], label=name)
plot.set(xlabel="time (s)", ylabel="wrist to trunk (cm)", ylim=(0, None))
plot.legend()
figure(
    fig,
    "One set of angles on two bodies, at the moment when the left hand is nearest. "
    "On the stout body the wrist is always closer to the trunk.",
)
report(
    nearest_on_the_slim_body_in_cm=100 * gaps["slim"].min(),
    nearest_on_the_stout_body_in_cm=100 * gaps["stout"].min(),
    always_nearer_on_the_stout_body=bool((gaps["stout"] < gaps["slim"]).all()),
)

# %% [markdown]
# The same angles leave 5.0 cm on one body and 2.0 cm on the other; a BVH file cannot tell. This is
# AMUSE's reason to leave BVH aside [AM G]. Its authors got the *marker points* behind the BEAT
# recordings and fitted SMPL-X to them, shape included. Methods trained on bare skeletons put limbs
# into bodies once a surface is laid over them [AM Fig. A.8].
#
# ## 6. Pictures of sound
#
# A waveform hides what an ear hears. So AMUSE first asks: *how much energy is there at each
# frequency, now?* The **filterbank** cuts the sound into windows of 25 ms, one every 10 ms, and adds up
# the energy in 128 bands. The bands are narrow for low tones and wide for high ones, as in the ear. Then it
# takes the logarithm, as loudness does.

# %%
ask("01-p3")

# %%
from s2glib.audio import (
    FRAME_RATE,
    HANDCRAFTED_NAMES,
    chroma,
    filterbank,
    handcrafted_features,
    mel_filters,
    mfcc,
    tempogram,
)

rate = sound.sample_rate
ten_seconds = np.zeros(10 * rate, np.float32)
report(
    this_clip=filterbank(sound.samples, rate, frames=None).shape,
    ten_seconds=filterbank(ten_seconds, rate, frames=None).shape,
    as_AMUSE_wants_it=filterbank(ten_seconds, rate).shape,
)

# %% [markdown]
# AMUSE reads every 10 s as a picture of 1024 x 128 [AM B.5]. The step from one window to the next is
# the *hop*, here 160 samples; a window has 400. So ten seconds hold
# $\lfloor (160000 - 400) / 160 \rfloor + 1 = 998$ windows, and the last 26 rows are padding.
#
# Other pictures ask other questions. **MFCC** keeps the broad shape of each spectrum, which is the
# shape of the mouth. **Chroma** asks which of twelve pitch classes sounds. The **tempogram** asks after how
# long the rhythm repeats.

# %% tags=["s2g-figure"]
hop = 512
cepstrum = mfcc(sound.samples, rate, coefficients=20, hop_length=hop)
pictures = {
    "mel band": (filterbank(sound.samples, rate, frames=None), 100),
    "coefficient number": ((cepstrum - cepstrum.mean(axis=0)) / cepstrum.std(axis=0), rate / hop),
    "pitch class": (chroma(sound.samples, rate, hop_length=hop), rate / hop),
}
titles = (
    "filterbank: bright is loud",
    "MFCC: bright is above its mean",
    "chroma: bright is strong",
)
fig, panels = plt.subplots(3, 1, figsize=(9, 7), sharex=True)
for axes, (name, (picture, frame_rate)) in zip(panels, pictures.items(), strict=True):
    draw_features(axes, picture, frame_rate, name)
    axes.set(xlabel="", xlim=(0, motion.duration))
for axes, title in zip(panels, titles, strict=True):
    axes.set_title(title, loc="right", fontsize=10, y=1.31 if axes is panels[0] else 1)
draw_words(panels[0], *words)
centres = mel_filters(rate // 2 + 1, rate).argmax(axis=0)  # Hz: one value of the spectrum each
hertz = [100, 300, 1000, 3000]
panels[0].set_yticks(np.searchsorted(centres, hertz) + 0.5, [f"{f} Hz" for f in hertz])
panels[2].set_yticks([0.5, 4.5, 7.5, 11.5], ["C", "E", "G", "B"])
panels[2].set(xlabel="time (s)")
figure(
    fig,
    "Three pictures of one sentence. In the first, a voiced sound is a ladder of bright lines, its "
    "harmonics; dark gaps are stops. In the third, a bright band is the melody of the voice.",
)

# %% [markdown]
# *Harmonics* are the whole multiples of a voice's pitch; *stops* are sounds like p, t and k, which shut the
# mouth for a moment. Mind two things about chroma. Each column is rescaled so that its largest value is
# 1, hence it is bright even in silence. And pitch classes go round: from B to C the band jumps from top to
# bottom, but the voice does not.
#
# ProbTalk takes another way: a large network trained on speech, **wav2vec 2.0**, listens to the waveform
# for it. MDD uses both ways, with a network of the same family, **WavLM**.
#
# ## 7. Onsets and beats
#
# Gestures care about *when* something starts. **Onset strength** measures how much new energy comes in.
# **Onsets** are its peaks. **Beats** are a steady pulse fitted to it, as if speech were music.

# %% tags=["s2g-figure"]
from s2glib.audio import beat_times, onset_strength, onset_times

strength = onset_strength(sound.samples, rate)
onsets, beats = onset_times(sound.samples, rate), beat_times(sound.samples, rate)

fig, axes = plt.subplots(figsize=(9, 3))
axes.plot(np.arange(len(strength)) / FRAME_RATE, strength, color=PALETTE["black"])
marks = {
    "stressed vowels": (clip.stress_times, "*", "vermilion"),
    "beats": (beats, "d", "green"),
    "onsets": (onsets, "v", "blue"),
}
for row, (name, (times, mark, colour)) in enumerate(marks.items()):
    height = (1.3 - 0.1 * row) * strength.max()
    axes.plot(times, np.full(len(times), height), mark, color=PALETTE[colour], label=name)
axes.set(xlabel="time (s)", ylabel="onset strength")
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
figure(
    fig,
    "Onset strength of the sentence. Every stressed vowel has an onset close by, "
    "but few onsets have a stressed vowel; beats keep a pulse of their own.",
)

# %%
ask("01-p4")

# %%
first, *_, last = clip.stress_times
moments = np.random.default_rng(0).uniform(first, last, 10_000)


def share_near_an_onset(times, reach):
    """Share of some times that have an onset within so many seconds."""
    return (np.abs(onsets[:, None] - times).min(axis=0) < reach).mean()


report(
    stressed_syllables=len(clip.stress_times),
    onsets=len(onsets),
    beats=len(beats),
    share_of_stresses_within_a_tenth_of_a_second=share_near_an_onset(clip.stress_times, 0.1),
    share_of_random_moments_within_a_tenth=share_near_an_onset(moments, 0.1),
    share_of_stresses_within_a_twentieth=share_near_an_onset(clip.stress_times, 0.05),
    share_of_random_moments_within_a_twentieth=share_near_an_onset(moments, 0.05),
)

# %% [markdown]
# An onset is near every stress, and near almost everything else too. Without the random moments, 7 of 7
# would have looked like a discovery. Within 0.05 s it is six of seven stresses, and still more than half of
# all moments. Remember this when a paper scores "beat alignment" (notebook 18): it aligns with onsets, not
# with stress.
#
# ## 8. Many rates, one clock
#
# Every stream has its own rate. With a hop of so many samples from one window to the next,
#
# $$\text{frames per second} = \frac{\text{samples per second}}{\text{hop}}$$

# %%
rates = {
    "motion of ProbTalk and AMUSE": 30,
    "motion of MDD": 25,
    "filterbank, hop 160 at 16 kHz": 16000 / 160,
    "features of MDD, hop 512 at 12.8 kHz": 12800 / 512,
    "MFCC of ProbTalk, hop 535 at 16 kHz": 16000 / 535,
}
late = {hop: 1800 * hop / 16000 - 60 for hop in (533, 535)}
report(
    **rates,
    seconds_late_after_a_minute_at_hop_533=late[533],
    seconds_late_after_a_minute_at_hop_535=late[535],
    frames_late_after_a_minute_at_hop_535=30 * late[535],
)

# %% [markdown]
# Look at the last two rates, and what follows from them. MDD resamples its sound to 12.8 kHz, so that one
# hop of 512 samples *is* one video frame. No whole hop gives 30 frames at 16 kHz. The whole hop nearest to
# 533.3 is 533. ProbTalk's MFCC option takes 535; after a minute it is late by more than five frames.
#
# To change a rate, ask each stream what it does *at a time*, never *at an index*.
#
# ### Exercise 01-3: the same motion at another rate
#
# ●●● · 15 minutes · [MDD 4.1]
#
# New frame $k$ shows the body at $k / \text{fps}$ seconds. That falls between two old frames, say a share
# $s = 0.2$ of the way from one to the next. Place and face go straight: take $1 - s$ of one and $s$ of the
# other. A joint *turns* from its matrix $A$ to its matrix $B$, and the turn between them is $A^\top B$. So
# write that as axis-angle, take $s$ of it, and turn on from $A$. After the last old frame the body stays
# as it is.
#
# `Motion(poses, trans, expression, fps)` makes a motion; its poses are axis-angles.


# %% tags=["s2g-exercise"]
def resample_motion(motion, fps):
    """The motion at another rate; it has floor(motion.duration * fps) frames."""
    ...  # your code


# %% tags=["s2g-solution"]
def resample_motion(motion, fps):
    """The motion at another rate; it has floor(motion.duration * fps) frames."""
    frames = int(motion.duration * fps)
    place = torch.arange(frames, dtype=motion.poses.dtype) / fps * motion.fps
    place = place.clamp(max=motion.frames - 1)
    before = place.floor().long()
    after = (before + 1).clamp(max=motion.frames - 1)
    share = (place - before)[:, None]
    A, B = axis_angle_to_matrix(motion.poses[before]), axis_angle_to_matrix(motion.poses[after])
    turn = matrix_to_axis_angle(A.mT @ B)
    poses = matrix_to_axis_angle(A @ axis_angle_to_matrix(share[:, None] * turn))
    trans = torch.lerp(motion.trans[before], motion.trans[after], share)
    expression = torch.lerp(motion.expression[before], motion.expression[after], share)
    return Motion(poses, trans, expression, fps)


# %% tags=["s2g-check", "nbval-ignore-output"]
resample_motion = check("01-3", resample_motion)

# %% tags=["s2g-source"]
show_solution("01-3")

# %%
from s2glib.corpus import Cell, render_motion

at_25 = resample_motion(motion, 25)
report(
    frames_at_30=motion.frames,
    frames_at_25=at_25.frames,
    features_at_25=handcrafted_features(sound.samples, rate, fps=25).shape,
    frame_60_at_30_is_at=60 / 30,
    frame_50_at_25_is_at=50 / 25,
    they_show_one_pose=torch.allclose(at_25.poses[50], motion.poses[60], atol=1e-4),
)

# %% [markdown]
# ## 9. Do gestures follow stressed syllables?
#
# In notebook 00 you may have *seen* that hands arrive with stressed syllables. Now measure it: the speed of
# the wrists, and the moments at which stressed vowels begin.

# %% tags=["s2g-figure"]
wrists = [joint("left_wrist"), joint("right_wrist")]


def wrist_speed(motion):
    """Mean speed of both wrists (m/s), and the time of each value (s)."""
    steps = joint_positions(motion, body)[:, wrists].diff(dim=0).norm(dim=-1).mean(dim=1)
    return steps.numpy() * motion.fps, (np.arange(len(steps)) + 0.5) / motion.fps


speed, when = wrist_speed(motion)

fig, axes = plt.subplots(figsize=(9, 3))
axes.plot(when, speed, color=PALETTE["blue"])
for moment in clip.stress_times:
    axes.axvline(moment, color=PALETTE["vermilion"], linestyle="--", linewidth=1.2)
axes.set(xlabel="time (s)", ylabel="wrist speed (m/s)")
figure(
    fig,
    "Wrist speed in our clip; dashed lines are the starts of stressed vowels. "
    "Do the hands slow down at the lines? At some they do, at others they do not.",
)

# %% [markdown]
# One clip proves little. So take all clips, put every stressed vowel at time zero, and average. Do
# the same around *random* moments: whatever shows there is chance.

# %%
ask("01-p5")

# %% tags=["s2g-figure"]
from s2glib.data import clips

around = np.linspace(-0.4, 0.4, 25)  # seconds
rng = np.random.default_rng(0)


def mean_speed_around(pick):
    """Wrist speed around some moments of every clip, as a share of the clip's mean."""
    tracks = []
    for name in clips():
        each = load_clip(name)
        speed, when = wrist_speed(each.motion)
        tracks += [np.interp(moment + around, when, speed / speed.mean()) for moment in pick(each)]
    return np.mean(tracks, axis=0)


def random_moments(each):
    return rng.uniform(each.stress_times.min(), each.stress_times.max(), len(each.stress_times))


stressed = mean_speed_around(lambda each: each.stress_times)
chance = mean_speed_around(random_moments)

fig, axes = plt.subplots(figsize=(7, 3.4))
axes.plot(around, stressed, color=PALETTE["vermilion"], label="stressed vowels")
axes.plot(around, chance, color=PALETTE["black"], linestyle="--", label="random moments")
axes.set(xlabel="time from the moment (s)", ylabel="speed / mean speed", ylim=(0, None))
axes.legend()
figure(
    fig,
    "Mean wrist speed around stressed vowels and around random moments, over all clips. "
    "It peaks about 0.15 s before the vowel and is lowest as the vowel begins.",
)

# %%
report(
    clips=len(clips()),
    fastest_before_the_vowel=around[stressed.argmax()] < 0,
    slow_when_the_vowel_begins=np.interp(0, around, stressed) < 0.8,
    flat_around_random_moments=np.ptp(chance) < 0.2,
)

# %% [markdown]
# The hand strikes first and *arrives* with the vowel. The pattern is as clear as this because our corpus
# was built with it; in people it is there, but weaker. What matters here: the link between sound and motion lies
# in *timing*, and now you have a way to see it.
#
# ## 10. Where the clips come from
#
# No one was recorded. A program writes each clip from its *factors*: which sentence, which voice,
# which emotion. So you can render a clip again, or clips that are not shipped, such as the same sentence
# by somebody else, once angry and once sad. A `Cell` names sentence, voice, emotion and take:

# %%
same = render_motion(Cell(4, "voice_13", "anger", 2))
angry, sad = (render_motion(Cell(4, "voice_02", emotion, 2)) for emotion in ("anger", "sadness"))
again = joint_positions(same.motion, body).numpy()
report(
    same_recipe_gives_the_shipped_motion=bool(np.abs(again - places).max() < 2e-3),
    angry_frames=angry.motion.frames,
    sad_frames=sad.motion.frames,
)

# %% [markdown]
# Sentence, voice and take are the same, so the emotion alone makes the sad clip longer: each emotion has
# its own tempo. Known factors are the workbook's best
# tool. Later you will ask a network to change the emotion only, and *know* the right answer.
#
# ## 11. Paper check
#
# Can you derive the numbers that MDD prints in B.5?

# %%
WAVLM = 1024  # width of WavLM-Large, the speech network of MDD
features = handcrafted_features(sound.samples, rate, fps=25)
groups = {"onset strength": 1, "mfcc": 20, "chroma": 12, "onset": 1, "beat": 1}
report(
    numbers_per_frame_of_motion=20 * 5 * 2,
    seconds_of_80_frames=80 / 25,
    audio_features=features.shape[1] + WAVLM,
    our_35=len(HANDCRAFTED_NAMES) == sum(groups.values()) == features.shape[1],
    with_a_tempogram=sum(groups.values()) + tempogram(sound.samples, rate).shape[1],
)

# %% [markdown]
# | claim [MDD B.5] | what we computed | verdict |
# |---|---|---|
# | motion is 200 numbers a frame | 20 warps (bends of the picture) x 5 keypoints x 2 coordinates | holds |
# | 80 frames are 3.2 s | 80 / 25 | holds |
# | audio is 1059 numbers a frame | 35 + 1024 | holds |
# | the 35 hold MFCC, chroma, *tempogram*, onset strength, onset beat | 20 + 12 + 1 + 1 are 34, and beats make 35; a tempogram of the usual size alone has 384 | **does not fit**: the released code has no tempogram |
#
# ## 12. Check yourself

# %%
ask("01-q1")

# %%
ask("01-q2")

# %%
ask("01-q3")

# %%
ask("01-q4")

# %%
ask("01-q5")

# %% [markdown]
# And one without an answer: which of your own movements, while you speak, could *no* sound feature explain?
#
# ## Summary
#
# - A clip is frames x joints x 3 angles, and samples, on one clock.
# - Networks say 6D, because it never jumps and every answer is a turn.
# - Forward kinematics turns angles into places, skinning turns places into a surface.
# - Filterbank, MFCC and chroma ask different questions of one sound.
# - Gestures arrive with stressed syllables; compare with random moments before you believe it.
#
# **Limits.** One synthetic corpus, with fewer habits than any person. Our mannequin has one shape; SMPL-X has
# many, and a licence of its own (notebook 21).
#
# **Back:** [00 Start here](00_start_here.ipynb). **Next:** [02 Thin-plate splines](02_thin_plate_splines.ipynb), which bend a
# picture.
