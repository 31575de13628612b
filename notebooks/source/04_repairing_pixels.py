# ---
# jupyter:
#   s2g: {"id": "04", "minutes": 66, "needs": ["03"], "goals": ["weigh the places that matter by masks", "say why L1 leaves hands out when in doubt", "compute a style loss and a total variation", "measure by gradient how far a network sees", "say what each term of a loss wants"], "papers": {"MDD": ["B.3", "B.5", "K"]}, "demos": ["loss mixer"], "data": ["shipped"], "budget_s": 25, "exercises": ["04-1", "04-2", "04-3"], "questions": ["04-p1", "04-p2", "04-p3", "04-q1", "04-q2", "04-q3", "04-q4"], "reached": {"weigh the places that matter by masks": ["04-p1", "04-1", "04-q1"], "say why L1 leaves hands out when in doubt": ["04-p2", "loss mixer"], "compute a style loss and a total variation": ["04-2", "04-3", "04-q2"], "measure by gradient how far a network sees": ["04-p3", "04-q3"], "say what each term of a loss wants": ["loss mixer", "04-q4"]}}
# ---

# %% [markdown]
# # Repairing pixels: why do the hands go missing?
#
# | | |
# |---|---|
# | After this you can | weigh the places that matter by masks; say why L1 leaves hands out when in doubt; compute a style loss and a total variation; measure by gradient how far a network sees; say what each term of a loss wants |
# | You need | [03 Motion decoupling](03_motion_decoupling.ipynb) |
# | Time | 40 minutes, and 26 for the exercises |
# | Papers | MDD B.3 (Eqs. B17-B21), weights in B.5, limits in K |
# | Data | four clips that come with the workbook; no network was trained on them |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("04")

# %% [markdown]
# ## 1. What the decoupler leaves
#
# The decoupler of notebook 03 bends a source picture until it looks like the driving one. It cannot bend what
# the source does not show: the inside of a hand, or the wall behind an arm. There it paints. How well?

# %% tags=["s2g-figure"]
from s2glib.corpus import appearances, render_video
from s2glib.data import load_clip
from s2glib.folders import data_folder
from s2glib.papers.mddiffusion import Masks, MDDiffusion
from s2glib.viz import draw_heatmap, draw_picture

HELD_OUT = "s04-voice_13-anger", "s01-voice_01-happiness", "s10-voice_03-fear", "s03-voice_05-anger"
EXAMPLE = 12  # a frame that we look at closely

system = MDDiffusion.load(data_folder() / "checkpoints")
clips = [load_clip(f"{name}-t2") for name in HELD_OUT]
videos = [render_video(clip, appearances(clip.speaker)[0], 64, fps=5) for clip in clips]
truths = [torch.from_numpy(video.frames).movedim(-1, 1).float() / 255 for video in videos]
source = torch.cat([truth[:1].expand_as(truth) for truth in truths])
truth = torch.cat(truths)
with torch.no_grad():
    made = system.decoupler(source, truth)
picture = made.synthesis.image
hand, face = (
    torch.cat([torch.from_numpy(getattr(video, f"{part}_mask")).float() for video in videos])[
        :, None
    ]
    for part in ("hand", "face")
)
masks = Masks(made.flow.occlusion_masks[-1], hand, face)


def show(axes, image, title, *, heat=None, place=(0, 0, 1)):
    """A picture, perhaps with heat on it; `place` is the middle and half the width of a part."""
    x, y, half = place
    if heat is None:
        draw_picture(axes, image.numpy())
    else:
        draw_heatmap(axes, image.numpy(), heat.numpy())
    axes.set_title(title)
    axes.set(xlim=(x - half, x + half), ylim=(y + half, y - half))
    axes.set_axis_off()


places = {"hand": (-0.5, 0.2, 0.3), "face": (0, -0.45, 0.3)}
fig, panels = plt.subplots(2, 4, figsize=(10, 5.2))
for axes, image, title in zip(
    panels[0], (source, truth, picture), ("source", "driving: the truth", "decoupler"), strict=False
):
    show(axes, image[EXAMPLE], title)
error = (truth - picture).abs().mean(dim=1)
show(panels[0, 3], truth[EXAMPLE], "error", heat=error[EXAMPLE])
for k, (part, place) in enumerate(places.items()):
    show(panels[1, 2 * k], truth[EXAMPLE], f"{part}: truth", place=place)
    show(panels[1, 2 * k + 1], picture[EXAMPLE], f"{part}: decoupler", place=place)
figure(
    fig,
    "A frame that no network was trained on. Trunk, hair and wall come out well; the error sits in "
    "arms, hands and face.",
    exact=False,
)
report(
    frames=len(truth),
    hands_are_worse_than_the_whole=bool(error[hand[:, 0] > 0].mean() > error.mean()),
    the_face_is_worse_than_the_whole=bool(error[face[:, 0] > 0].mean() > error.mean()),
)

# %% [markdown]
# A listener looks at the hands and the face. So MDD adds a **refinement network**: it takes the decoupler's picture
# and the finest occlusion mask, and returns a repaired picture. This notebook is about what to ask of it.
#
# ## 2. Where to look
#
# Our renderer notes for every pixel what it painted, so it knows where the hands are. The authors had real videos. They
# found hands by MediaPipe, cut them out by MobileSAM, and kept the *box* about each.

# %% tags=["s2g-figure"]
from s2glib.corpus import Part
from s2glib.viz import draw_boxes, draw_masks

HANDS = Part.LEFT_HAND, Part.RIGHT_HAND
parts = videos[0].parts[EXAMPLE]
fig, axes = plt.subplots(figsize=(4.2, 4.2))
draw_masks(
    axes, truth[EXAMPLE].numpy(), {"hands": parts >= Part.LEFT_HAND, "face": parts == Part.FACE}
)
draw_boxes(axes, [parts == part for part in HANDS])
figure(
    fig,
    "Exact masks of hands and face, and the boxes that the authors' code would use. "
    "A box also holds wall and clothes.",
)


def boxes(mask):
    """The smallest box about each mask of a film."""
    return mask.any(axis=1, keepdims=True) & mask.any(axis=2, keepdims=True)


one_hand = [video.parts == part for video in videos for part in HANDS]
report(
    hands_are_of_all_pixels=hand.mean(),
    the_face_is_of_all_pixels=face.mean(),
    hand_is_of_its_box=sum(m.sum() for m in one_hand) / sum(boxes(m).sum() for m in one_hand),
)

# %% [markdown]
# ## 3. Two pixels in a hundred
#
# The plain L1 loss, the mean of $|\mathbf{D} - \hat{\mathbf{D}}|$, gives the hands what they have of the pixels: 2 %. A network
# that forgets all hands loses next to nothing. Hence MDD takes one mean for each region [MDD B17]:
#
# $$\mathcal{L}_{rec} = \mathcal{L}_{valid} + \lambda_{occ} \mathcal{L}_{occ} + \lambda_{hand} \mathcal{L}_{hand} + \lambda_{face} \mathcal{L}_{face},
# \qquad \lambda_{occ} = 3,\; \lambda_{hand} = \lambda_{face} = 5$$
#
# *Valid* is what the decoupler took from the source, *occluded* what it had to paint.
#
# ### Exercise 04-1: the error inside a mask
#
# ●○○ · 8 minutes · [MDD Eq. B17]
#
# The paper does not say how a region's error is averaged. The released code sums it inside the mask and
# divides by the mask's area times three colours, picture by picture; then it takes the mean over the pictures. Where a
# mask is empty, the error is 0.
#
# As always, you may skip an exercise: the notebook then goes on with the package's function.


# %% tags=["s2g-exercise"]
def masked_l1(image, image_hat, mask):
    """Pictures (batch, 3, h, w), masks (batch, 1, h, w); one number."""
    ...  # your code


# %% tags=["s2g-solution"]
def masked_l1(image, image_hat, mask):
    """Pictures (batch, 3, h, w), masks (batch, 1, h, w); one number."""
    inside = ((image - image_hat).abs() * mask).sum(dim=(1, 2, 3))
    area = image.shape[1] * mask.sum(dim=(1, 2, 3))
    return (inside / area.clamp_min(1e-9)).mean()


# %% tags=["s2g-check", "nbval-ignore-output"]
masked_l1 = check("04-1", masked_l1)

# %% tags=["s2g-source"]
show_solution("04-1")

# %% [markdown]
# So a hand counts five times as much as the visible rest. **Predict:** and one *pixel* of a hand?

# %%
ask("04-p1")

# %% [markdown]
# Ask the gradient: what does one more unit of error cost at each pixel?

# %% tags=["s2g-figure"]
WEIGHTS = {"valid": 1, "occluded": 3, "hand": 5, "face": 5}
frame = slice(EXAMPLE, EXAMPLE + 1)
visible = masks.visible[frame]
regions = {"valid": visible, "occluded": 1 - visible, "hand": hand[frame], "face": face[frame]}
wrong = torch.ones(1, 3, 64, 64, requires_grad=True)
terms = {name: masked_l1(torch.zeros_like(wrong), wrong, mask) for name, mask in regions.items()}
(cost,) = torch.autograd.grad(sum(WEIGHTS[name] * term for name, term in terms.items()), wrong)
times = cost[0, 0] * wrong.numel()  # as many times as in a plain mean

fig, axes = plt.subplots(figsize=(4.6, 3.8))
shown = axes.imshow(times.log10().numpy())
fig.colorbar(shown).ax.set(xlabel="log10", ylabel="times a plain mean")
axes.set_axis_off()
figure(
    fig,
    "What a unit of error costs at each pixel under B17, compared with a plain mean. Hands and "
    "face stand out, and so does what was occluded.",
    exact=False,
)
report(
    five_times_all_pixels_over_those_of_the_hands=5 * hand[frame].numel() / hand[frame].sum(),
    and_over_those_of_the_face=5 * face[frame].numel() / face[frame].sum(),
    a_hand_pixel_costs_over_100_wall_pixels=bool(
        times[hand[EXAMPLE, 0] > 0].min() > 100 * times[0, 0]
    ),
)

# %% [markdown]
# The division by the area does most of it, not the 5.
#
# ## 4. In doubt, leave it out
#
# Hands have a second enemy: from a blurred input, no network can know where each finger is. What does L1 ask for, then? Take
# it to the extreme. **Predict:**

# %%
ask("04-p2")

# %% tags=["s2g-figure"]
clip = clips[0]
video = render_video(clip, appearances(clip.speaker)[0], 64)
film = torch.from_numpy(video.frames).movedim(-1, 1).float() / 255
guesses = {"one frame": film[60], "mean": film.mean(dim=0), "median": film.median(dim=0).values}
seen = torch.from_numpy(video.hand_mask).float().mean(dim=0)

fig, panels = plt.subplots(1, 4, figsize=(10, 2.9))
for axes, (name, guess) in zip(panels, guesses.items(), strict=False):
    show(axes, guess, name)
show(panels[3], film[60], "how often a hand is here", heat=seen)
figure(
    fig,
    "Three ways to guess a frame of a film. The median has the least L1 error, and no hands: no place "
    "shows one most of the time.",
)
report(
    **{f"mean error: {name}": (film - guess).abs().mean() for name, guess in guesses.items()},
    pixels_of_hands_in_a_frame=seen.sum(),
    pixels_with_a_hand_most_of_the_time=(seen > 0.5).sum(),
)

# %% [markdown]
# Where the network is in doubt, L1 paints the median of what might be: no hand, no blink, a smooth sleeve. That is the blur of
# L1 (the mean of squares would paint ghosts). The hand term pulls the other way, and too far: it looks only where hands
# *are*, so a hand too many costs little. You will see it in section 11.
#
# ## 5. Compare features, not pixels
#
# A blurred sleeve, or a sharp one that is off by a pixel: L1 prefers the blurred one, our eyes do not. So compare
# *features*, such as edges. MDD takes maps $F_i$ of VGG-16 (after its first three poolings, $i = 5, 10, 17$) twice: place by place [MDD
# B18], and as **Gram matrices** [MDD B19]:
#
# $$\mathcal{L}_{per} = \sum_i |F_i - \hat{F}_i|, \qquad \mathcal{L}_{style} = \sum_i |F_i F_i^\top - \hat{F}_i \hat{F}_i^\top|$$
#
# $F$ has a row for each channel and a column for each place. So $(F F^\top)_{jk}$ sums over all places how far channels $j$ and $k$
# are high together. Where that happens is lost: what remains is texture.
#
# ### Exercise 04-2: texture without place
#
# ●●○ · 12 minutes · [MDD Eq. B19]
#
# As in the released code, divide $F F^\top$ by channels x height x width, and take the mean of the absolute differences. Sum
# over the maps.


# %% tags=["s2g-exercise"]
def style_loss(features, features_hat):
    """Two lists of maps (batch, c, h, w); one number."""
    ...  # your code


# %% tags=["s2g-solution"]
def style_loss(features, features_hat):
    """Two lists of maps (batch, c, h, w); one number."""

    def matrix(f):
        flat = f.flatten(2)
        return flat @ flat.mT / f[0].numel()

    pairs = zip(features, features_hat, strict=True)
    return sum((matrix(f) - matrix(f_hat)).abs().mean() for f, f_hat in pairs)


# %% tags=["s2g-check", "nbval-ignore-output"]
style_loss = check("04-2", style_loss)

# %% tags=["s2g-source"]
show_solution("04-2")

# %% [markdown]
# VGG-16 is a download of half a gigabyte, so we compare **colours and edges** (differences to the right and below)
# instead. Edges have six channels; we can look at their Gram matrices.

# %%
from s2glib.body import Motion
from s2glib.corpus import render_frames
from s2glib.layers import PyramidFeatures
from s2glib.losses import gram, perceptual_loss

motion = clip.motion
first = Motion(motion.poses[:1], motion.trans[:1], motion.expression[:1], fps=25)
large = render_frames(first, appearances(clip.speaker)[0], size=256).frames[0]
large = torch.from_numpy(large).movedim(-1, 0).double()[None] / 255
cloth, wall = large[..., 150:198, 104:152], large[..., 190:238, 4:52]
moved = cloth.roll((4, 4), dims=(-2, -1))
blurred = torch.nn.functional.avg_pool2d(cloth, 5, stride=1, padding=2, count_include_pad=False)
patches = {"cloth": cloth, "moved": moved, "blurred": blurred, "wall": wall}
features = {name: PyramidFeatures(1)(patch) for name, patch in patches.items()}


def differences(loss):
    """How far the three others are from the cloth."""
    return [loss(features["cloth"], features[name]) for name in ("moved", "blurred", "wall")]


report(
    compared_with_the_cloth="(moved, blurred, wall)",
    L1=[(cloth - patches[name]).abs().mean() for name in ("moved", "blurred", "wall")],
    perceptual=differences(perceptual_loss),
    style=differences(style_loss),
)

# %% tags=["s2g-figure"]
from s2glib.viz import draw_gram

EDGES = [f"{way} {colour}" for way in "→↓" for colour in ("red", "green", "blue")]

fig, panels = plt.subplots(2, 4, figsize=(10, 5.2))
matrices = {name: gram(maps[1])[0].numpy() for name, maps in features.items()}  # of the edges
for (top, bottom), (name, patch) in zip(panels.T, patches.items(), strict=True):
    show(top, patch[0], name)
    draw_gram(bottom, matrices[name], EDGES, peak=matrices["cloth"].max())
    bottom.set(xlabel="channel", ylabel="channel")
figure(
    fig,
    "Cloth, the same shifted by four pixels, blurred, and wall; below, the Gram matrices of their edges, "
    "to one scale. Moved, the cloth keeps its matrix; blurred, it fades.",
)

# %% [markdown]
# L1 prefers the blurred cloth to the moved one, by far, and so does the perceptual loss here, since it wants edges in
# their place. The style loss turns this around. One says where, the other how sharp; neither is enough.
#
# ## 6. Smooth, but not too smooth
#
# Against speckles, MDD adds **total variation**: the differences between neighbours [MDD B20].
#
# ### Exercise 04-3: total variation
#
# ●○○ · 6 minutes · [MDD Eq. B20]
#
# B20 prints sums; write the mean over all vertical neighbours plus the mean over all horizontal ones, for which the weight
# of 0.1 is meant. Leave `mask` alone.


# %% tags=["s2g-exercise"]
def total_variation(image, mask=None):
    """Pictures (batch, c, h, w); one number."""
    ...  # your code


# %% tags=["s2g-solution"]
def total_variation(image, mask=None):
    """Pictures (batch, c, h, w); one number."""
    return image.diff(dim=-2).abs().mean() + image.diff(dim=-1).abs().mean()


# %% tags=["s2g-check", "nbval-ignore-output"]
total_variation = check("04-3", total_variation)

# %% tags=["s2g-source"]
show_solution("04-3")

# %%
report(**{name: total_variation(patch) for name, patch in patches.items()})

# %% [markdown]
# It knows no truth: it likes the wall best, and would rather have the cloth blurred. So its weight is small.
#
# ## 7. A critic that looks at patches
#
# The last term has no formula. A **critic**, the *patch discriminator*, learns to tell true pictures from made ones, and the
# refinement wants to be taken for true. The critic scores every patch; in the released code 1 is true, 0 is made, by least
# squares (LSGAN):
#
# $$\mathcal{L}_D = \tfrac12 \bigl( \overline{(D(\mathbf{D}) - 1)^2} + \overline{D(\hat{\mathbf{D}})^2} \bigr), \qquad
# \mathcal{L}_G = \overline{(D(\hat{\mathbf{D}}) - 1)^2}$$
#
# Train a small one for 30 steps, on two of our speakers, against the decoupler. What does it say of the other two?

# %% tags=["s2g-figure"]
from s2glib.losses import discriminator_loss
from s2glib.papers.mddiffusion import TEACHING_REFINEMENT, PatchDiscriminator

known = sum(map(len, truths[:2]))  # frames of the first two speakers
critic = PatchDiscriminator(TEACHING_REFINEMENT)
adam = torch.optim.Adam(critic.parameters(), lr=1e-3, betas=(0.5, 0.999))
for _ in range(30):
    rows = torch.randint(known, (8,))
    loss = discriminator_loss(critic(truth[rows]), critic(picture[rows]))
    adam.zero_grad()
    loss.backward()
    adam.step()
critic.eval()
with torch.no_grad():
    true_scores, made_scores = critic(truth), critic(picture)

means = [scores[known:].mean(dim=(1, 2, 3)) for scores in (made_scores, true_scores)]
fig, panels = plt.subplots(1, 3, figsize=(9.5, 3.2))
show(panels[0], truth[-1], "true")
show(panels[1], picture[-1], "made")
panels[2].scatter(*means, s=14, color=PALETTE["blue"])
panels[2].axline((means[0].mean(),) * 2, slope=1, color=PALETTE["black"], linestyle=":")
panels[2].set(xlabel="score of the made picture", ylabel="score of the true one")
figure(
    fig,
    "A pair of pictures of a speaker whom the critic has never seen, and the mean scores of all such pairs. "
    "Above the line, the true one scores higher.",
    exact=False,
)
higher = (means[1] > means[0]).float().mean()
report(in_most_unseen_pairs_the_true_one_scores_higher=bool(higher > 0.5))

# %% [markdown]
# (Spectral norms keep it tame: no layer may stretch its input, so the scores stay close.)
#
# How large is a patch? Take the gradient of one score, and count the pixels where it is not zero: the score's
# **receptive field**.

# %%
from dataclasses import replace

from s2glib.papers.mddiffusion import PAPER_REFINEMENT, RefinementNet


def field(number, image):
    """How many columns of a picture one number depends on."""
    (gradient,) = torch.autograd.grad(number, image, retain_graph=True)
    return int(gradient.abs().sum(dim=(0, 1)).any(dim=0).sum())


narrow = replace(PAPER_REFINEMENT, patch_widths=(4, 8, 8, 8))  # the paper's shape, fewer channels
noise = torch.rand(1, 3, 256, 256, dtype=torch.float64, requires_grad=True)
scores = PatchDiscriminator(narrow).double()(noise)
patch = field(scores[0, 0, 13, 13], noise)
report(scores=scores.shape[-2:], pixels_across_a_patch=patch)

# %% [markdown]
# ## 8. A network that sees near and far
#
# The refinement network is a **U-Net**: eight blocks halve the picture, eight double it again, and each level hands its maps over
# to the other side. Two residual blocks sit at half size and two at full size. "Simultaneously possessing large and small
# receptive fields" is the idea [MDD B.3]. **Predict:**

# %%
ask("04-p3")

# %% tags=["s2g-figure"]
from s2glib.viz import draw_receptive_fields

unet = RefinementNet(replace(PAPER_REFINEMENT, widths=(2,) * 8)).double().eval()
wide = torch.rand(1, 4, 1024, 1024, dtype=torch.float64, requires_grad=True)
h, fields = wide, {}
for level, block in enumerate(unet.down, start=1):
    h = block(h)
    fields[f"level {level}"] = field(h[0, :, h.shape[2] // 2, h.shape[3] // 2].sum(), wide)
tail = torch.rand(1, 2, 64, 64, dtype=torch.float64, requires_grad=True)
fields["residual tail"] = field(unet.last(unet.large(tail))[0, 0, 32, 32], tail)

colours = torch.rand(1, 3, 256, 256, dtype=torch.float64, requires_grad=True)
repaired = unet(colours, torch.ones(1, 1, 256, 256, dtype=torch.float64))
(touched,) = torch.autograd.grad(repaired[0, 0, 128, 128], colours)
strength = touched[0].abs().sum(dim=0)
coarse = torch.nn.functional.avg_pool2d(strength[None], 4)[0]  # to show
shown_large = truth[EXAMPLE].repeat_interleave(4, 1).repeat_interleave(4, 2)  # 256 pixels again

fig, panels = plt.subplots(1, 2, figsize=(11, 3.7))
chosen = {name: fields[name] for name in ("residual tail", "level 4", "level 6")}
draw_receptive_fields(panels[0], shown_large.numpy(), {**chosen, "patch of the critic": patch})
panels[0].set(title="pixels across")
shown = panels[1].imshow(coarse.log10().numpy(), extent=(0, 256, 256, 0))
panels[1].set(title="one output pixel (untrained)", xlabel="x (pixels)", ylabel="y (pixels)")
fig.colorbar(shown).ax.set(xlabel="log10", ylabel="its gradient")
figure(
    fig,
    "Left: how far some levels see. Right: how strongly one output pixel depends on every pixel of the "
    "input: on its neighbours by the tail, faintly on all others.",
    exact=False,
)
report(
    **fields,
    pixels_that_one_output_pixel_sees=int((strength > 0).sum()),
    all_pixels=256 * 256,
)

# %% [markdown]
# Level by level 4, 10, 22, ... : each field is twice the last one plus two. The deepest level could see a picture three times as large as
# MDD's. The tail sees 15 pixels, enough for an edge. So the deep levels may find out *that* a hand is missing, and
# the tail draws it.
#
# ## 9. Before and after
#
# Now our own refinement network, small (five levels for 64 pixels) and trained on other clips:

# %% tags=["s2g-figure"]
with torch.no_grad():
    refined = system.refiner(picture, masks.visible).clamp(0, 1)
starts = torch.tensor([0, *map(len, truths[:-1])]).cumsum(0)
rows = starts + EXAMPLE
stages = {"truth": truth, "decoupler": picture, "refined": refined}
fig, panels = plt.subplots(3, 4, figsize=(8.2, 6.9))
for line, (name, images) in zip(panels, stages.items(), strict=True):
    for axes, image in zip(line, images[rows], strict=True):
        show(axes, image, name)
figure(
    fig,
    "A frame of each of the four clips: the truth, what the decoupler made of the clip's first frame, "
    "and the same after refinement.",
    exact=False,
)
errors = {
    name: [masked_l1(truth, image, mask).item() for mask in (*masks, torch.ones_like(hand))]
    for name, image in {"before": picture, "after": refined}.items()
}
falls = [after < before for before, after in zip(errors["before"], errors["after"], strict=True)]
report(
    hand_error_falls=falls[1],
    face_error_falls=falls[2],
    refined_is_better=falls[3],
)

# %% [markdown]
# Hands and face gain a little; the picture as a whole does not. A pixel of a hand costs over a hundred times one of
# the wall, and the network pays for hands with the rest. Nor can it know how a hand was held that the flow has smeared: a hand
# before the chest stays a blur.
#
# ### What is each part good for?
#
# MDD's Fig. E1 shows hands and faces that were bent by splines or by MRAA's regions (notebook 03), repaired or not.
# Here is the same as numbers. These runs are short, for they show an order, not what can be reached:

# %% tags=["s2g-figure"]
import json

from s2glib.folders import runs_folder

runs = [
    json.loads(path.read_text())["figures"]
    for path in sorted(runs_folder().glob("mddiffusion-ablation-teaching-*.json"))
]
KINDS = {"affine": "regions", "affine, refined": "regions,\nrepaired"}
KINDS |= {"splines": "splines", "splines, refined": "splines,\nrepaired"}
fig, panels = plt.subplots(1, 2, figsize=(9, 3.1))
for axes, region in zip(panels, ("hand", "face"), strict=True):
    for seed, run in enumerate(runs):
        shares = [run[f"{kind}: {region}"] for kind in KINDS]
        axes.plot(list(KINDS.values()), shares, "os^"[seed], label=f"seed {seed}")
    axes.set(xlabel="bent by", ylabel="error / of the still picture", title=f"{region}s")
panels[0].legend(fontsize=10)
figure(
    fig,
    "Errors on hands and on faces of films that the networks have not seen, as shares of the error of a still "
    "picture. Lower is better.",
)


def less(one, other, region):
    """Whether one kind has less error than the other: with every seed, in the mean, or not."""
    gains = [run[f"{other}: {region}"] - run[f"{one}: {region}"] for run in runs]
    return "every seed" if min(gains) > 0 else "in the mean" if sum(gains) > 0 else "no"


report(
    runs=len(runs),
    splines_beat_regions_on_hands=less("splines", "affine", "hand"),
    splines_beat_regions_on_faces=less("splines", "affine", "face"),
    repair_helps_hands=less("splines, refined", "splines", "hand"),
    repair_helps_faces=less("splines, refined", "splines", "face"),
)

# %% [markdown]
# An arm bends: splines win on hands, and clearly. A head moves as one piece, and an affine map will do: on faces splines win by
# little, and not with every seed.
#
# ### Twice the pixels
#
# Is a hand of six pixels simply too small? Two more networks come with the workbook, for 128 pixels. They began with the weights of those above, and find keypoints and flow on
# pictures as small as before. Only the finest mask is new, and those who paint learned finer detail.

# %% tags=["s2g-figure"]
from s2glib.recipes import mddiffusion_128

larger = MDDiffusion.load(data_folder() / "checkpoints", size=128)
video = render_video(clips[0], appearances(clips[0].speaker)[0], 128, fps=5)
video = torch.from_numpy(video.frames).movedim(-1, 1).float() / 255
(painted,) = larger.reenact(video[0], video[[EXAMPLE]]).frames
fig, panels = plt.subplots(1, 3, figsize=(6.9, 2.6))
images = refined[EXAMPLE], painted, video[EXAMPLE]
titles = "64 pixels", "128 pixels", "truth"
for axes, image, title in zip(panels, images, titles, strict=True):
    show(axes, image, title)
figure(
    fig,
    "One frame at both sizes. Cloth, hair and face are sharp at 128 pixels; a hand that has moved is still a smear.",
    exact=False,
)
sizes = {64: "mddiffusion-refinement", 128: "mddiffusion-refinement-128"}
recorded = {
    size: json.loads((runs_folder() / f"{name}-teaching-0.json").read_text())["figures"]
    for size, name in sizes.items()
}
report(
    steps_of_both_networks_after_those_of_64=[
        lesson.course.steps for lesson in (mddiffusion_128.DECOUPLING, mddiffusion_128.REFINEMENT)
    ],
    parameters={
        size: sum(p.numel() for p in one.decoupler.parameters())
        for size, one in {64: system, 128: larger}.items()
    },
    **{
        f"{region} region, error over the still picture's": {
            size: one[f"{region}, refined / copied"] for size, one in recorded.items()
        }
        for region in ("moving", "hand", "face")
    },
)

# %% [markdown]
# The pixels that move most gain, and the face does. Hands are as wrong as before: what they lack is not pixels but a flow that carries
# them. And at both sizes a faint trace stays where an arm has been.
#
# Here is a part of the film, with its sound. Everything is made from the first frame.

# %% tags=["s2g-media", "nbval-ignore-output"]
from s2glib.widgets import FilmPlayer

part = film[:60]
with torch.no_grad():
    played = system.decoupler(part[:1].expand_as(part), part)
    repaired = system.refiner(played.synthesis.image, played.flow.occlusion_masks[-1]).clamp(0, 1)
films = {"decoupler": played.synthesis.image, "refined": repaired}
FilmPlayer(films, fps=25, waveform=clip.waveform)

# %% [markdown]
# ## 10. Who gets the loss?
#
# All terms together [MDD B21; weights B.5]:
#
# $$\mathcal{L}_{ref} = \mathcal{L}_{rec} + 0.05\, \mathcal{L}_{per} + 120\, \mathcal{L}_{style} + 0.1\, \mathcal{L}_{tv} + 0.1\, \mathcal{L}_{G}$$
#
# A weight says little, for the terms have different sizes. Look at the *products*, for the decoupler's own pictures, where
# training starts:

# %% tags=["s2g-figure"]
from s2glib.papers.mddiffusion import refinement_losses
from s2glib.recipes.mddiffusion_refinement import LESSONS

WEIGHTS |= {"perceptual": 0.05, "style": 120, "total_variation": 0.1, "adversarial": 0.1}
ours = LESSONS["teaching"].weights  # what our recipe changes
products = refinement_losses(picture, truth, masks, PyramidFeatures(), made_scores)


def shares(weights):
    """Each weighted term over the sum of all."""
    parts = {name: weight * getattr(products, name).item() for name, weight in weights.items()}
    return {name: part / sum(parts.values()) for name, part in parts.items()}


kinds = {"the paper's weights": shares(WEIGHTS), "ours": shares(WEIGHTS | ours)}
fig, axes = plt.subplots(figsize=(8, 3.4))
for k, (kind, colour) in enumerate(zip(kinds, ("blue", "orange"), strict=True)):
    heights = [row + 0.4 * k for row in range(len(WEIGHTS))]
    axes.barh(heights, kinds[kind].values(), 0.4, color=PALETTE[colour], label=kind)
axes.set_yticks(heights, [name.replace("_", " ") for name in WEIGHTS])
axes.invert_yaxis()
axes.set(xlabel="share of the loss", ylabel="term")
axes.legend()
figure(
    fig,
    "Each weighted term's share in the loss of a real batch, with colours and edges in place of VGG-16.",
    exact=False,
)
paper = sum(weight * getattr(products, name) for name, weight in WEIGHTS.items())
report(
    the_products_sum_to_L_ref=torch.allclose(paper, products.total()),
    largest=max(kinds["the paper's weights"], key=kinds["the paper's weights"].get),
    smallest=min(kinds["the paper's weights"], key=kinds["the paper's weights"].get),
)

# %% [markdown]
# The paper's weights come from a search with VGG-16 and other pictures. With our features they leave the perceptual term
# without a say, so our recipe weighs two terms anew.
#
# ## 11. What does each term want?
#
# Take the network away, and let gradient descent change the *pixels* of the decoupler's picture. Where a term leads, if nothing holds
# it back, is what it wants.

# %%
from s2glib.widgets import LossMixer

poses = torch.tensor([EXAMPLE, 1, 4])  # the truth, and two frames that might be it


def crop(images):
    """48 x 48 pixels of the three poses."""
    return images[poses][..., :48, 8:56]


mixer = LossMixer(crop(picture)[0], crop(truth), Masks(*map(crop, masks)))
mixer.selftest()

# %% tags=["s2g-figure"]
L1 = {"valid": 1, "occluded": 3}
wishes = {
    "start": mixer.repaint(),
    "truth": crop(truth)[0],
    "style alone": mixer.repaint(style=120),
    "total variation": mixer.repaint(total_variation=1),
    "in doubt: L1": mixer.repaint("one of several", **L1),
    "and hands": mixer.repaint("one of several", **L1, hand=5),
}
fig, panels = plt.subplots(1, 6, figsize=(12, 2.4))
for axes, (name, wish) in zip(panels, wishes.items(), strict=True):
    show(axes, wish, name)
figure(
    fig,
    "Where some terms lead from the decoupler's picture. In doubt means that three poses of the hands are "
    "equally likely: L1 all but drops them, with the hand term all of them appear.",
    exact=False,
)
doubt, pulled = (
    (crop(truth)[1:] - wishes[name]).abs().mean(dim=1) for name in ("in doubt: L1", "and hands")
)
elsewhere = crop(hand)[1:, 0] > 0  # hands of the two other poses
report(
    hand_term_paints_hands_of_other_poses=bool(pulled[elsewhere].mean() < doubt[elsewhere].mean())
)

# %% [markdown]
# Now you. It starts with our recipe's weights, without the critic.

# %% tags=["s2g-demo"]
mixer

# %% [markdown]
# Three things to try:
#
# <details><summary>1. Everything to 0, then <em>hand</em> alone. Then <em>pose</em>: one of several.</summary>
#
# First, only the hands are repaired; a hand of the old pose stays where it is, since nobody looks there. In
# doubt, a fan of hands appears.
# </details>
#
# <details><summary>2. Everything to 0, then <em>style</em> alone. Do hands come?</summary>
#
# The picture gets crisper, in the right mixture of colours and edges, but no hand comes: style does not know where.
# </details>
#
# <details><summary>3. <em>Total variation</em> to 3, and <em>hand</em> and <em>face</em> from 5 to 0.</summary>
#
# With their weights, hands and face stay sharp in a molten room. Without, they melt, too.
# </details>
#
# ## 12. Paper check

# %%
from s2glib.papers.mddiffusion import merge

merged = merge(picture, refined, masks.visible)
changed = (picture - made.synthesis.warped).abs()  # by the decoupler's paint
one = torch.ones(1, 1, 64, 64)
half = (torch.arange(64) < 32).float().expand_as(one)
vgg_map = 64 * 128 * 128  # channels x height x width after the first pooling, for 256 pixels
report(
    where_masks_are_1_the_source_is_kept=bool((changed <= 1 - masks.visible + 1e-5).all()),
    most_hand_pixels_are_marked_visible=bool((masks.visible[hand > 0] > 0.5).float().mean() > 0.5),
    hands_are_better_before_merging=errors["after"][1] < masked_l1(truth, merged, hand).item(),
    slope_of_tanh_at_a_wall_of_nine_tenths=1 - 0.9**2,
    F_F_transposed_is_larger_by=vgg_map,
    variation_of_white_times_a_mask=total_variation(one * half),
)

# %% [markdown]
# | claim [MDD B.3, B.5] | what we computed | verdict |
# |---|---|---|
# | L_valid uses "the complement of the occlusion masks" | the masks are 1 where the bent source is kept | **reversed**, unless 1 meant hidden; the code takes the mask itself |
# | $\lambda_{face} = 5$ | a face pixel costs 158 times a plain one; the released code has no face term | ours has it |
# | hands are segmented [B.3] | of a box, two thirds are hand | the code keeps the box |
# | $F F^\top$ [B19] | a million times larger than what 120 was searched for | the divisor is missing in print |
# | $\lambda_{G}$ in B21, $\lambda_{GAN}$ in B.5 | both 0.1 | one weight, two names |
# | the last layer is not told | the code ends in tanh: -1 to 1, for pictures in 0 to 1 | half of its range is no colour; ours adds to its input |
# | $\hat{\mathbf{D}}_{ref}$ is the result | the code shows `merge`: the prediction where visible, the repair elsewhere | a repaired hand shows only where the mask lets it through |
# | $\mathcal{L}_{tv}$ on the whole picture | the code multiplies by the mask first, whose edge alone has a variation | not the same term |
#
# ## 13. Check yourself

# %%
ask("04-q1")

# %%
ask("04-q2")

# %%
ask("04-q3")

# %%
ask("04-q4")

# %% [markdown]
# And one without an answer: MDD's authors still see blurred hands [MDD K]. Which term would *you* add?
#
# ## Summary
#
# - A mean over a mask gives a small hand a loud voice: its area, more than its weight, decides.
# - In doubt L1 paints the median: no hands. A hand term paints too many.
# - Gram matrices keep which features go together and drop where; L1 keeps where.
# - Receptive fields can be measured: one gradient, and count.
# - Weights mean nothing without the sizes of their terms.
#
# **Limits.** Drawn speakers, 64 or 128 pixels, exact masks, no VGG. Frames are repaired one by one, so nothing keeps them from flickering.
#
# **Back:** [03 Motion decoupling](03_motion_decoupling.ipynb). **Next:** notebook 05 leaves pictures, and turns motion into
# codes.
