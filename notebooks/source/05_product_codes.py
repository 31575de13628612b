# ---
# jupyter:
#   s2g: {"id": "05", "minutes": 83, "needs": ["01"], "goals": ["turn vectors into codes and say why rounding has no slope", "pass a gradient through a quantiser", "let codes follow their vectors and keep them all alive", "count what product codes can name, store and cost", "choose between one codebook, product and residual codes", "say what a code means on the body"], "papers": {"PT": ["A.1"]}, "demos": ["codebook explorer"], "data": ["shipped"], "budget_s": 25, "exercises": ["05-1", "05-2", "05-3", "05-4"], "questions": ["05-p1", "05-p2", "05-p3", "05-q1", "05-q2", "05-q3", "05-q4"], "reached": {"turn vectors into codes and say why rounding has no slope": ["05-1", "05-p1"], "pass a gradient through a quantiser": ["05-2", "05-q1"], "let codes follow their vectors and keep them all alive": ["05-3", "05-4", "05-p2", "05-q2", "05-q4"], "count what product codes can name, store and cost": ["05-p3"], "choose between one codebook, product and residual codes": ["05-q3"], "say what a code means on the body": ["codebook explorer"]}}
# ---

# %% [markdown]
# # Product codes: how can four small tables name every gesture?
#
# | | |
# |---|---|
# | After this you can | turn vectors into codes; pass a gradient through a quantiser; let codes follow their vectors and keep them alive; count what product codes can name, store and cost; choose between one codebook, product and residual codes; say what a code means on the body |
# | You need | [01 Motion and sound](01_motion_and_sound.ipynb) |
# | Time | 50 minutes, and 33 for the exercises |
# | Papers | PT A.1 |
# | Data | clips that come with the workbook |

# %% tags=["s2g-setup"]
import matplotlib.pyplot as plt
import numpy as np
import torch

from s2glib.teaching import PALETTE, ask, check, figure, report, setup, show_solution

setup("05")

# %% [markdown]
# ## 1. A gesture in 88 whole numbers
#
# ProbTalk predicts gestures as a language model predicts words: it chooses from a list, piece by piece. For that, motion must first
# become words. Its **PQ-VAE** (product-quantised variational auto-encoder) makes them. An *encoder* turns every 8 frames into one vector, a **latent**; a *quantiser* replaces it by entries of fixed tables, a **token**, so that nothing but their numbers, the **codes**, need be kept; a *decoder* makes motion of them.
#
# Here is ours, before and after.

# %% tags=["s2g-figure"]
from s2glib.body import Motion, mannequin
from s2glib.checkpoint import load_checkpoint
from s2glib.data import clips, load_clip
from s2glib.folders import data_folder, runs_folder
from s2glib.papers.probtalk import PQVAE
from s2glib.viz import draw_bodies

body = mannequin()
model = load_checkpoint(data_folder() / "checkpoints" / "probtalk-pqvae.safetensors", PQVAE)
config, features = model.config, model.features


def window(motion):
    """The first 176 frames as standardised features; a short clip holds its last pose."""
    held = torch.arange(config.frames).clamp_max(motion.frames - 1)
    return features.from_motion(motion.poses[held].float(), motion.expression[held].float())


def posed(motion):
    """Features as a body's motion, standing where bodies stand."""
    place = clip.motion.trans[:1].float().repeat(len(motion), 1)
    return Motion(features.to_poses(motion), place, features.to_expression(motion), fps=30)


clip = load_clip("s04-voice_13-anger-t2")
motion = window(clip.motion)
with torch.no_grad():
    codes = model.encode(motion[None])[0]  # (tokens, groups)
    made = model.decode(codes[None])[0]

fig, panels = plt.subplots(2, 1, figsize=(7, 4.4), sharex=True)
for axes, moved, title in zip(
    panels, (motion, made), ("the clip", "made of its codes"), strict=True
):
    draw_bodies(axes, posed(moved), body, (0.4, 1.2, 2.0, 2.8)).set(title=title)
panels[0].set(xlabel="")
figure(
    fig,
    "Four moments of a clip that the PQ-VAE was not trained on, and the same after a journey through whole numbers.",
    exact=False,
)
still = (motion - motion.mean(0)).abs().mean()
report(
    frames_and_numbers_in_each=motion.shape,
    tokens_and_codes_in_each=codes.shape,
    bits_of_all_codes=codes.numel() * int(np.log2(config.codes)),
    the_codes_keep_more_than_a_still_mean_pose=bool((made - motion).abs().mean() < still),
)

# %% [markdown]
# The motion: jaw, upper body, hands and face, 50 688 numbers. The codes: 88 numbers from 0 to 127, 77 bytes. That is what this notebook
# takes apart.
#
# | letter | here | elsewhere |
# |---|---|---|
# | $z$ | a vector before the quantiser | |
# | $e_k$ | entry $k$ of a table | $e$ is the emotion latent in AM |
# | $G$, $K$ | groups, entries of a table | $K$ is the number of splines in MDD |
# | $w$ | frames of a token, 8 | weights of a spline in MDD |
#
# ## 2. The nearest entry
#
# A **codebook** is a table of $K$ vectors. To *encode* a vector, take the number of the nearest entry; to *decode* a number, look it up:
#
# $$k = \arg\min_j \lVert z - e_j \rVert^2, \qquad \hat z = e_k$$
#
# ### Exercise 05-1: the nearest code
#
# ●●○ · 8 minutes · [PT A.1]
#
# Prepare for more: a vector may come in several *groups*, each with a table of its own. `z` is (..., groups, dim), `vectors` (groups, codes, dim).
#
# As always, you may skip an exercise: the notebook then goes on with the package's function.


# %% tags=["s2g-exercise"]
def nearest_codes(z, vectors):
    """The number of the nearest vector, in each group's own table: (..., groups)."""
    ...  # your code


# %% tags=["s2g-solution"]
def nearest_codes(z, vectors):
    """The number of the nearest vector, in each group's own table: (..., groups)."""
    return (z[..., None, :] - vectors).square().sum(-1).argmin(-1)


# %% tags=["s2g-check", "nbval-ignore-output"]
nearest_codes = check("05-1", nearest_codes)

# %% [markdown]
# Stuck? Open a hint. The solution is the package's own code.

# %% tags=["s2g-source"]
show_solution("05-1")

# %% [markdown]
# In two dimensions one can see it: entries cut the plane into cells.

# %% tags=["s2g-figure"]
chance = torch.Generator().manual_seed(3)


def normal(*shape):
    """Random numbers around 0."""
    return torch.randn(shape, generator=chance, dtype=torch.float64)


points, table = normal(300, 2), normal(1, 8, 2)
row = torch.linspace(-3.2, 3.2, 240, dtype=torch.float64)
places = torch.stack(torch.meshgrid(row, row, indexing="xy"), dim=-1)


def draw_cells(axes, codes_of, vectors, data):
    """Data, entries, and borders between the cells of places that get the same code."""
    cells = codes_of(places)
    edges = (cells.diff(dim=0)[:, 1:] != 0) | (cells.diff(dim=1)[1:] != 0)
    axes.imshow(
        edges.numpy(), extent=(-3.2, 3.2, -3.2, 3.2), origin="lower", cmap="Greys", alpha=0.7
    )
    axes.plot(*data.T, ".", color=PALETTE["sky"], markersize=2)
    axes.plot(*vectors.T, "o", color=PALETTE["vermilion"], markersize=6)
    axes.set(xlabel="channel 1", ylabel="channel 2", xlim=(-3.2, 3.2), ylim=(-3.2, 3.2))


fig, axes = plt.subplots(figsize=(4, 3.8))
draw_cells(axes, lambda z: nearest_codes(z[..., None, :], table)[..., 0], table[0], points)
for number, (x, y) in enumerate(table[0].tolist()):
    axes.annotate(str(number), (x, y), xytext=(4, 4), textcoords="offset points")
figure(
    fig,
    "Eight entries and their cells. All points of a cell become the same number, and come back as its entry.",
)
near = nearest_codes(points[:, None], table)[:, 0]
report(
    first_points_become=near[:6],
    mean_squared_error=(points - table[0][near]).square().sum(-1).mean(),
)

# %% [markdown]
# ## 3. A staircase has no slope
#
# An encoder learns by gradients. **Predict first.**

# %%
ask("05-p1")

# %% tags=["s2g-figure"]
entries = torch.tensor([-2.0, -0.5, 0.5, 2.0], dtype=torch.float64)
line = torch.linspace(-3, 3, 601, dtype=torch.float64)
stairs = entries[nearest_codes(line[:, None, None], entries[None, :, None])[:, 0]]
wanted = 1.2
fig, panels = plt.subplots(1, 2, figsize=(8, 3), sharex=True)
panels[0].plot(line, stairs)
panels[0].set(xlabel="z", ylabel="nearest entry")
panels[1].plot(line, (stairs - wanted) ** 2, label="after the table")
panels[1].plot(line, (line - wanted) ** 2, label="without it")
panels[1].set(xlabel="z", ylabel="loss")
panels[1].legend(fontsize=10)
figure(
    fig,
    "A table makes a staircase of a number, and a staircase of every loss behind it: flat, but for jumps.",
)
flat = (stairs.diff() == 0).double().mean()
report(share_without_any_slope=flat)

# %% [markdown]
# The way out of its ancestor with one table, VQ-VAE (*vector-quantised*), is a bold lie, the **straight-through estimator**: forward the entry, but backward act as if nothing had been
# done. What the decoder asks of $\hat z$ is passed to $z$ as it is. That is not the gradient. But it points to where the encoder should go, if
# entries lie close.
#
# ### Exercise 05-2: straight through
#
# ●○○ · 6 minutes · [PT A.1]
#
# One line. `.detach()` makes a constant of a tensor. The check looks at gradients, too: `z` gets 1, `nearest` none.


# %% tags=["s2g-exercise"]
def straight_through(z, nearest):
    """As a value `nearest`, with the gradient of `z`."""
    ...  # your code


# %% tags=["s2g-solution"]
def straight_through(z, nearest):
    """As a value `nearest`, with the gradient of `z`."""
    return z + (nearest - z).detach()


# %% tags=["s2g-check", "nbval-ignore-output"]
straight_through = check("05-2", straight_through)

# %% tags=["s2g-source"]
show_solution("05-2")


# %%
def looked_up(z):
    """The nearest of the four entries."""
    return entries[nearest_codes(z[:, None, None], entries[None, :, None])[:, 0]]


def slope(quantised, at=-1.6):
    """What an encoder in front would hear."""
    z = torch.tensor([at], dtype=torch.float64, requires_grad=True)
    loss = (quantised(z) - wanted).square().sum() + 0 * z.sum()
    return torch.autograd.grad(loss, z)[0]


def last_entries(quantised, z=-1.6):
    """The entries of the last steps of gradient descent."""
    seen = []
    for _ in range(80):
        z -= 0.02 * slope(quantised, z).item()
        seen.append(looked_up(torch.tensor([z], dtype=torch.float64)).item())
    return sorted(set(seen[-20:]))


report(
    heard_after_the_table=slope(looked_up),
    heard_straight_through=slope(lambda z: straight_through(z, looked_up(z))),
    entry_at_the_start=looked_up(torch.tensor([-1.6], dtype=torch.float64)),
    entries_at_the_end=last_entries(lambda z: straight_through(z, looked_up(z))),
)

# %% [markdown]
# The value travels from -2 to the two entries around the wanted 1.2. There it swings: at 0.5 the loss pulls up, at 2 it pulls down, and there is nothing
# between. The lie has its price.
#
# ## 4. Who moves the entries?
#
# Straight through, no gradient reaches the table. So two losses are added, the same number twice:
#
# $$\underbrace{\lVert \mathrm{sg}[z] - e_k \rVert^2}_{\text{codebook: moves the entry}} \qquad \underbrace{\lVert z - \mathrm{sg}[e_k] \rVert^2}_{\text{commitment: moves what is encoded}}$$
#
# "sg" stops the gradient. The commitment loss keeps the encoder from running away; the released code's weight is 0.25.

# %%
from s2glib.quantization import ClusterTotals, Codebook

torch.manual_seed(0)
book, z = Codebook(8, 2).double(), normal(50, 2).requires_grad_()
out = book(z)


def reaches(loss):
    """What a loss has a gradient for."""
    sources = {"entries": book.tables.vectors, "encoded": z}
    found = torch.autograd.grad(loss, list(sources.values()), retain_graph=True, allow_unused=True)
    return " and ".join(
        name for name, gradient in zip(sources, found, strict=True) if gradient is not None
    )


report(
    codebook_loss_reaches=reaches(out.codebook_loss),
    commitment_loss_reaches=reaches(out.commitment_loss),
    a_loss_behind_it_reaches=reaches(out.vectors.square().sum()),
    both_are_equal=bool(out.codebook_loss == out.commitment_loss),
)

# %% [markdown]
# The released code has no codebook loss. There is a better rule than gradient steps: an entry is best at the *mean* of the vectors that choose it. Means over all
# data would be k-means; over batches, take **moving averages**. For every entry keep how many vectors chose it, and
# their sum. Both fade by a factor, 0.99, as new batches come in:
#
# $$N_k \leftarrow 0.99\, N_k + 0.01\, n_k, \qquad s_k \leftarrow 0.99\, s_k + 0.01 \sum_{z\ \text{chose}\ k} z, \qquad e_k = s_k / N_k$$
#
# ### Exercise 05-3: let the past fade
#
# ●●● · 12 minutes · [PT A.1]
#
# `totals.sizes` (codes,), `totals.sums` (codes, dim); `z` (n, dim) chose `codes` (n,). `decay` is the 0.99 of the formula, `1 - decay` the 0.01. Return new totals, do not change the old.


# %% tags=["s2g-exercise"]
def running_totals(totals, z, codes, decay):
    """ClusterTotals(sizes, sums) after one more batch."""
    ...  # your code


# %% tags=["s2g-solution"]
def running_totals(totals, z, codes, decay):
    """ClusterTotals(sizes, sums) after one more batch."""
    chosen = torch.nn.functional.one_hot(codes, len(totals.sizes)).to(z.dtype)
    return ClusterTotals(
        decay * totals.sizes + (1 - decay) * chosen.sum(0),
        decay * totals.sums + (1 - decay) * chosen.mT @ z,
    )


# %% tags=["s2g-check", "nbval-ignore-output"]
running_totals = check("05-3", running_totals)

# %% tags=["s2g-source"]
show_solution("05-3")

# %% [markdown]
# Let eight entries follow a cloud of points, with a past and without one.

# %%
data = normal(4096, 2)


def followed(decay, batches):
    """The mean squared error on all data, batch after batch of 128, and the entries."""
    vectors, errors = table[0].clone(), []
    totals = ClusterTotals(vectors.new_zeros(8), vectors.new_zeros(8, 2))
    for number in range(batches):
        z = data[128 * (number % 32) :][:128]
        totals = running_totals(totals, z, nearest_codes(z[:, None], vectors[None])[:, 0], decay)
        vectors = totals.sums / totals.sizes.clamp_min(1e-5)[:, None]
        codes_now = nearest_codes(data[:, None], vectors[None])[:, 0]
        errors.append((data - vectors[codes_now]).square().sum(-1).mean().item())
    return errors, vectors, totals


(slow, vectors, _), (fast, *_) = followed(0.9, 60), followed(0.0, 60)
report(
    the_error_falls=slow[-1] < slow[0],
    a_past_ends_lower_than_none=slow[-1] < fast[-1],
)

# %% tags=["s2g-figure"]
fig, panels = plt.subplots(1, 2, figsize=(9, 3.6), width_ratios=[1.3, 1])
panels[0].plot(range(1, 61), fast, label="no past: decay 0")
panels[0].plot(range(1, 61), slow, label="decay 0.9")
panels[0].set(xlabel="batches", ylabel="mean squared error")
panels[0].legend(fontsize=10)
draw_cells(
    panels[1], lambda z: nearest_codes(z[..., None, :], vectors[None])[..., 0], vectors, data[:300]
)
figure(
    fig,
    "The error falls as entries move to the means of their cells. Without a past they tremble with every batch. Right: entries after 60 batches.",
    exact=False,
)

# %% [markdown]
# (The released code's 0.99 is for thousands of batches; 60 are few, so we took 0.9.)
#
# **Bias correction.** Totals that start from zero are too small at first, by the factor $1 - 0.99^n$ after $n$ batches. The authors' code divides both by that, as Adam
# does. But look: $e_k$ is a *quotient*.

# %%
_, vectors, totals = followed(0.99, 60)
weight = 1 - 0.99**60
report(
    totals_hold=weight,
    entries_without_and_with_the_division=torch.allclose(
        (totals.sums / weight) / (totals.sizes / weight)[:, None], vectors
    ),
    vectors_per_batch_without_it=totals.sizes.sum(),
    vectors_per_batch_with_it=(totals.sizes / weight).sum(),
)

# %% [markdown]
# The entries do not care, the *sizes* do: only corrected do they count real vectors per batch. The next section needs that. (In the released code the
# number of batches is not saved with the rest, so a resumed run corrects wrongly. Ours is in the checkpoint.)
#
# ## 5. Dead codes
#
# **Predict first.**

# %%
ask("05-p2")

# %% [markdown]
# How many codes are in use? Counting those that occur is too kind: one may occur once in a thousand. **Perplexity** weighs them. With shares $p_k$:
#
# $$\text{perplexity} = \exp\Bigl(-\sum_k p_k \log p_k\Bigr)$$
#
# ### Exercise 05-4: how many codes are in use
#
# ●●○ · 7 minutes · [PT A.1]
#
# `codes` may have any shape. An unused code adds 0.


# %% tags=["s2g-exercise"]
def perplexity(codes, num_codes):
    """From 1 to num_codes, a float64 tensor without axes."""
    ...  # your code


# %% tags=["s2g-solution"]
def perplexity(codes, num_codes):
    """From 1 to num_codes, a float64 tensor without axes."""
    p = torch.bincount(codes.flatten(), minlength=num_codes).double() / codes.numel()
    p = p[p > 0]
    return (-(p * p.log()).sum()).exp()


# %% tags=["s2g-check", "nbval-ignore-output"]
perplexity = check("05-4", perplexity)

# %% tags=["s2g-source"]
show_solution("05-4")

# %% [markdown]
# Now the ring, three times.

# %%
from s2glib.quantization import MovingAverage, dead_codes

angle = 2 * torch.pi * torch.rand(4096, generator=chance, dtype=torch.float64)
MIDDLE = torch.tensor([1.6, 1.2], dtype=torch.float64)
ring = MIDDLE + torch.stack([angle.cos(), angle.sin()], 1) + 0.1 * normal(4096, 2)
KINDS = {
    "plain averages": MovingAverage(bias_correction=False, revive_below=0),
    "from zero": MovingAverage(revive_below=0),
    "revived": MovingAverage(),
}


def trained(book, data):
    """A quantiser after 200 batches of 128."""
    for number in range(200):
        book(data[128 * (number % 32) :][:128])
    return book.eval()


def ring_book(rule):
    """Sixteen entries that begin close to the middle of the ring."""
    torch.manual_seed(1)
    book = Codebook(16, 2, ema=rule).double()
    book.vectors.mul_(0.2).add_(MIDDLE)
    if not rule.bias_correction:
        book.tables.means.sums.copy_(book.tables.vectors)
    return trained(book, ring)


books = {name: ring_book(rule) for name, rule in KINDS.items()}
use = {name: book.encode(ring) for name, book in books.items()}
report(
    most_are_dead_if_plain=len(dead_codes(use["plain averages"], 16)) > 8,
    unused_ones_fell_into_the_origin=bool((books["from zero"].vectors.norm(dim=1) < 1e-6).any()),
    none_is_dead_if_revived=len(dead_codes(use["revived"], 16)) == 0,
    perplexity_of_the_revived_above_half=bool(perplexity(use["revived"], 16) > 8),
)

# %% tags=["s2g-figure"]
fig, panels = plt.subplots(1, 3, figsize=(11, 3.7), sharey=True)
for axes, (name, book) in zip(panels, books.items(), strict=True):
    draw_cells(axes, book.encode, book.vectors, ring[:400])
    axes.set(title=name)
    axes.label_outer()
figure(
    fig,
    "Sixteen entries after 200 batches. Left: unused ones stay in the middle. Centre: started from zero totals, they fell into the origin, far off. "
    "Right: dead codes begin again at a vector of the batch.",
    exact=False,
)

# %% [markdown]
# So a code whose corrected size falls below one vector per batch is **revived**: it becomes a vector of the current batch. (The authors take the first
# vectors of the batch, which are neighbours in time; ours come from all over it.) One suits the authors' batches; a code of ours is chosen three times a batch on average, so we took 0.15.
#
# How evenly does our PQ-VAE use its tables, on clips that it has not seen?

# %%
names = clips()[::4]
with torch.no_grad():
    all_codes = model.encode(torch.stack([window(load_clip(name).motion) for name in names]))
shares = [perplexity(group, config.codes) / config.codes for group in all_codes.unbind(-1)]
report(
    clips_and_codes=(len(names), all_codes.numel()),
    every_group_uses_more_than_a_third=min(shares) > 1 / 3,
)

# %% [markdown]
# ## 6. Product codes
#
# More codes name motion better. But each costs memory, search time, and data to learn from. A **product quantiser** cuts the vector into $G$ contiguous
# chunks, each with a small table of its own. **Predict** what that buys.

# %%
ask("05-p3")

# %%
from s2glib.quantization import ProductQuantizer, ResidualQuantizer

with torch.device("meta"):  # shapes only, no memory
    one, four = Codebook(128, 512), ProductQuantizer(4, 128, 512)
    per_token = four.encode(torch.empty(22, 512)).shape
as_many = 128**4 * 512 * 4  # bytes of one table with as many entries
report(
    numbers_stored_in_one_and_in_four=(one.vectors.numel(), four.codebooks.numel()),
    codes_of_22_tokens=per_token,
    bits_of_a_token=(np.log2(128), 4 * np.log2(128)),
    names=(128, 128**4),
    gigabytes_of_one_table_with_as_many_names=as_many / 1e9,
)

# %% [markdown]
# Same memory, same search (each table compares 128 entries with a quarter of the channels), 28 bits instead of 7. Is there a catch? The names form a
# *grid*: each of the four choices is blind to the others. A **residual quantiser** is another compromise: full width, stage by stage, each
# for what the stages before left over, with more memory. Look at all three in two dimensions, with 4 bits each: 16 entries (VQ), two groups of 4 (PQ), two stages of 4 (RQ).

# %% tags=["s2g-figure"]
torch.manual_seed(2)
turn = torch.tensor([[0.8, -0.6], [0.6, 0.8]], dtype=torch.float64)
together = data * torch.tensor([1.4, 0.3], dtype=torch.float64) @ turn.mT
shuffled = together[torch.randperm(len(data), generator=chance), 1]
CLOUDS = {"apart": torch.stack([together[:, 0], shuffled], dim=1), "together": together}


def quantisers(bits):
    """One table, two groups, two stages, all with so many bits, their codes following."""
    many, few = 2**bits, 2 ** (bits // 2)
    rules = [MovingAverage(0.95, revive_below=25 / codes) for codes in (many, few)]
    return {
        "VQ": Codebook(many, 2, ema=rules[0]).double(),
        "PQ": ProductQuantizer(2, few, 2, ema=rules[1]).double(),
        "RQ": ResidualQuantizer(2, few, 2, ema=rules[1]).double(),
    }


def every_name(quantiser):
    """All vectors that its codes can name."""
    if isinstance(quantiser, Codebook):
        return quantiser.vectors
    parts, count, _ = quantiser.codebooks.shape
    return quantiser.decode(torch.cartesian_prod(*parts * [torch.arange(count)]))


def cell_of(quantiser, z):
    """One number for each name."""
    found = quantiser.encode(z)
    return found if found.shape == z.shape[:-1] else found @ torch.tensor([100, 1])


def error(quantiser, cloud):
    """Mean squared error."""
    back = quantiser.decode(quantiser.encode(cloud))
    return (cloud - back).square().sum(-1).mean().item()


kinds = {
    name: {
        bits: {q: trained(each, cloud) for q, each in quantisers(bits).items()}
        for bits in (2, 4, 6)
    }
    for name, cloud in CLOUDS.items()
}
fig, panels = plt.subplots(2, 3, figsize=(9.6, 6.4), sharex=True, sharey=True)
for line_of, (name, cloud) in zip(panels, CLOUDS.items(), strict=True):
    for axes, (q, each) in zip(line_of, kinds[name][4].items(), strict=True):
        draw_cells(axes, lambda z, each=each: cell_of(each, z), every_name(each), cloud[:400])
        axes.set(title=f"{q}, {name}")
        axes.label_outer()
figure(
    fig,
    "Sixteen names each. Above: channels know nothing of each other, and PQ's grid is fine. Below: the same channels hang together; "
    "many names of the grid lie where no data are. RQ repeats one pattern around each coarse entry.",
    exact=False,
)
missed = {
    name: {q: error(each, CLOUDS[name]) for q, each in of[4].items()} for name, of in kinds.items()
}
report(
    apart_PQ_is_nearly_as_good_as_one_table=missed["apart"]["PQ"] < 1.4 * missed["apart"]["VQ"],
    PQ_does_not_notice_what_hangs_together=abs(missed["together"]["PQ"] / missed["apart"]["PQ"] - 1)
    < 0.1,
    one_table_makes_use_of_it=missed["together"]["VQ"] < 0.7 * missed["apart"]["VQ"],
    RQ_too=missed["together"]["RQ"] < 0.7 * missed["apart"]["RQ"],
)

# %% [markdown]
# Both clouds have the same two channels; in the upper one we shuffled the second, so that it knows nothing of the first. A product quantiser cannot tell the two apart.
#
# At equal *bits*, then, one table is best, if it can be stored, searched and trained. At equal *memory* it has far fewer names. Here are both views, with the bound
# of information theory, which no quantiser of whatever length of blocks gets below.


# %% tags=["s2g-figure"]
def bound(cloud, rates):
    """Least squared error at so many bits, for a Gaussian: reverse water-filling."""
    small, large = np.linalg.eigvalsh(np.cov(cloud.numpy().T))
    level = (small * large) ** 0.5 * 2.0**-rates
    return np.where(level < small, 2 * level, small + large * 4.0**-rates)


rates = np.linspace(2, 6, 41)
left_with = {
    (name, q): [error(each[q], CLOUDS[name]) for each in of.values()]
    for name, of in kinds.items()
    for q in ("VQ", "PQ", "RQ")
}
stored = {"VQ": [8, 32, 128], "PQ": [4, 8, 16], "RQ": [8, 16, 32]}  # numbers, with 2, 4, 6 bits
fig, panels = plt.subplots(1, 3, figsize=(11, 3.4), sharey=True)
for axes, name in zip(panels, ("apart", "together", "together"), strict=True):
    for q, mark in zip(stored, "os^", strict=True):
        across = stored[q] if axes is panels[2] else (2, 4, 6)
        axes.semilogy(across, left_with[name, q], mark + "-", label=q)
    axes.set(title=f"{name}, by bits", xlabel="bits")
for axes, name in zip(panels, CLOUDS, strict=False):
    axes.semilogy(
        rates, bound(CLOUDS[name], rates), color=PALETTE["black"], linestyle=":", label="bound"
    )
panels[0].set(ylabel="mean squared error")
panels[0].legend(fontsize=10)
panels[2].set_xscale("log", base=2)
panels[2].set(title="together, by memory", xlabel="numbers stored")
panels[0].minorticks_off()
panels[0].set_yticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
figure(
    fig,
    "The same quantisers by bits, for both clouds, and by memory. Which one wins depends on what is scarce.",
    exact=False,
)
report(
    nobody_beats_the_bound=all(
        left > bound(CLOUDS[name], bits)
        for (name, _), errors in left_with.items()
        for bits, left in zip((2, 4, 6), errors, strict=True)
    ),
    with_8_numbers_PQ_beats_one_table=all(
        left_with[name, "PQ"][1] < left_with[name, "VQ"][0] for name in CLOUDS
    ),
)

# %% [markdown]
# ## 7. And for gestures?
#
# The latents of a PQ-VAE are no fixed cloud: the encoder learns *with* the quantiser, and can arrange its channels so that a grid fits. So train the
# whole thing with each quantiser. These runs were recorded (`probtalk-codes`, three seeds, 500 steps each: enough to compare, too few to be good):

# %% tags=["s2g-figure"]
import json

from s2glib.recipes.code_scores import STUDY
from s2glib.recipes.probtalk_codes import STEPS

ARMS = ("PQ 4 x 128", "VQ 128", "VQ 4096", "PQ 4 x 8", "RQ 4 x 8")
runs = sorted(runs_folder().glob(f"{STUDY}-teaching-*.json"))
recorded = [json.loads(path.read_text())["figures"] for path in runs]
wrist = {arm: [run[f"{arm}: wrist error, cm"] for run in recorded] for arm in ARMS}
usage = {arm: [run[f"{arm}: perplexity / codes"] for run in recorded] for arm in ARMS}

fig, panels = plt.subplots(1, 2, figsize=(9, 3.4), sharey=True)
for axes, values, label in zip(
    panels, (wrist, usage), ("wrist error (cm)", "perplexity / codes"), strict=True
):
    for place, arm in enumerate(ARMS):
        axes.plot(values[arm], [place] * len(values[arm]), "o", color=PALETTE["blue"])
    axes.axhline(1.5, color=PALETTE["black"], linewidth=0.8)
    axes.set(xlabel=label, yticks=range(5), yticklabels=ARMS, ylim=(4.5, -0.5), xlim=(0, None))
panels[0].set(ylabel="quantiser")
figure(
    fig,
    "Test clips through five quantisers; a dot is a seed. Above the line: equal memory and search. Below: 12 bits for each token.",
    exact=False,
)
pairs = zip(wrist["PQ 4 x 128"], wrist["VQ 128"], strict=True)
means = {arm: np.mean(wrist[arm]) for arm in ARMS[2:]}
report(
    seeds=len(recorded),
    steps_of_each=STEPS,
    at_equal_memory_PQ_wins_with_every_seed=all(ours < theirs for ours, theirs in pairs),
    best_at_equal_bits=min(means, key=means.get),
    the_large_table_uses_its_entries_least=min(ARMS, key=lambda arm: np.mean(usage[arm]))
    == "VQ 4096",
)

# %% [markdown]
# At equal memory PQ wins by far: 28 bits of a token against 7. At equal bits the one large table wins, for its entries may lie wherever motion is. It pays with
# 2 million numbers, where PQ has 4096 and RQ 16 384, and uses its entries least evenly.
#
# ## 8. The network around it
#
# The encoder has four residual blocks of three convolutions; between them, convolutions of kernel 4, stride 2 and padding 1 halve the frames [PT A.1].

# %%
from s2glib.papers.probtalk import PAPER_PQVAE
from s2glib.papers.probtalk.pqvae import Resample
from s2glib.recipes.probtalk_pqvae import COURSES

with torch.device("meta"):
    paper = PQVAE(PAPER_PQVAE)
    x, halved = torch.empty(1, PAPER_PQVAE.size, PAPER_PQVAE.frames), []
    for layer in paper.encoder:
        x = layer(x)
        if isinstance(layer, Resample):
            halved.append(tuple(x.shape[1:]))
last = model.encoder[-1]  # "a fully connected layer"
with torch.no_grad():
    wide = model.encoder[:-1](motion.mT[None])
    by_token = torch.nn.functional.linear(wide.mT, last.weight[..., 0], last.bias)
    spoiled = motion.repeat(config.frames, 1, 1)
    spoiled[range(config.frames), range(config.frames)] = torch.nan  # one frame in each copy
    hears = model.latents(spoiled)[:, 11].isnan().any(-1)
report(
    channels_and_frames_after_each_halving=halved,
    frames_of_a_token=2 ** len(halved),
    last_layer_works_token_by_token=torch.allclose(by_token, last(wide).mT, atol=1e-4),
    frames_that_a_token_depends_on=int(hears.sum()),
    paper_size_in_millions_of_parameters=sum(p.numel() for p in paper.parameters()) / 1e6,
    steps_of_our_training=COURSES["teaching"].steps,
)

# %% [markdown]
# Three halvings make $w = 2^3 = 8$. The "fully-connected layer" must be one *per token*, a convolution of kernel 1: over all tokens it would fix the length of clips. And a token *stands for* 8
# frames, but has *seen* far more.
#
# Training compares what comes back part by part: jaw, body, hands and face each have a SmoothL1 of their own, so that 180 hand
# numbers do not drown 6 of the jaw; a velocity term asks for the true changes from frame to frame. (The paper prints no weights; they are the released code's.) To train within minutes, ours got help
# that the paper does without: a linear path beside both networks, which begins as principal components, and two terms, for where wrists are and how head, arms and hands move. All are off in the paper's
# size. Watch a small one begin, without the path:

# %%
from dataclasses import replace

from s2glib.papers.probtalk import TEACHING_PQVAE, pqvae_losses

torch.manual_seed(0)
small = PQVAE(replace(TEACHING_PQVAE, widths=(16, 16, 24, 32), straight=0, latent=32, codes=16))
adam = torch.optim.Adam(small.parameters(), 3e-3)
lessons = torch.stack([window(load_clip(name).motion)[:96] for name in names[::2]])
history = []
for _ in range(40):
    losses = pqvae_losses(small, lessons)
    adam.zero_grad()
    losses.total().backward()
    adam.step()
    history.append(losses.total().item())
report(
    terms=losses._fields,
    the_loss_has_fallen_by_a_third=history[-1] < 2 / 3 * history[0],
    batches_that_the_codes_counted=small.quantizer.tables.means.step,
)

# %% [markdown]
# ## 9. What does a code mean?
#
# Put another code into the row, and see what the decoder makes of it.

# %% tags=["s2g-figure"]
from s2glib.widgets import CodebookExplorer

explorer = CodebookExplorer(model, codes, body)
at_first = explorer.moved


def farthest(code):
    """How far a code of group 0 moves the body."""
    explorer.choose(token=8, group=0, code=code)
    return max(explorer.moved.values())


explorer.choose(token=8, group=0, code=max(range(0, config.codes, 16), key=farthest))
fig, axes = plt.subplots(figsize=(4.6, 3.4))
explorer.draw(axes)
figure(
    fig,
    "The explorer: one of 88 codes was exchanged, and the body in the middle of that token moves elsewhere.",
    exact=False,
)
before, after = (each.poses for each in explorer.motions.values())
changed = (after - before).abs().amax((1, 2))
largest = max(explorer.moved.values())
report(
    its_own_codes_change_nothing=set(at_first.values()) == {0.0},
    another_code_moves_the_body=largest > 0.01,
    most_change_is_within_two_tokens=8 * 6 <= int(changed.argmax()) < 8 * 11,
)

# %% tags=["s2g-demo"]
explorer

# %% [markdown]
# Three things to try:
#
# <details><summary>1. Walk through the codes of one group. Does a group have a body part of its own?</summary>
#
# No: nobody asked for that. Groups are channels of a latent, and each may move face, arms and hands.
# </details>
#
# <details><summary>2. Exchange a code near the start. When does the body begin to move differently?</summary>
#
# Before the token begins: the decoder's convolutions blend neighbours, so that tokens join smoothly.
# </details>
#
# <details><summary>3. Find a code that makes a pose which no person would take.</summary>
#
# You may find one: tokens were learned as foursomes, and a foursome which never occurred promises nothing. To choose them so that they fit
# is the work of notebook 06.
# </details>
#
# ## 10. Paper check
#
# | claim [PT A.1] | what we computed | verdict |
# |---|---|---|
# | $w = 8$ | three halvings: $2^3$ | holds |
# | "a fully connected layer precedes the quantization" | a convolution of kernel 1 is a linear layer for each token | **wording**: over the whole clip it would not fit other lengths |
# | convolutions "followed by" normalisation and LeakyReLU | the released code has plain ReLU at the end of blocks, and bare convolutions beside those with stride | the text leaves them out; ours follows the code |
# | product codes | at equal memory PQ beats VQ with every recorded seed | holds |
# | the same | at equal bits one table of 4096 entries beats PQ and RQ, with 512 and 128 times their memory | depends on what is scarce |
# | bias-corrected averages (code) | entries are quotients and do not change; sizes do | works, for another reason than it seems |
#
# ## 11. Check yourself

# %%
ask("05-q1")

# %%
ask("05-q2")

# %%
ask("05-q3")

# %%
ask("05-q4")

# %% [markdown]
# And one without an answer: what would a codebook of *your* gestures hold, if it had sixteen entries?
#
# ## Summary
#
# - A codebook names a vector by its nearest entry. That has no slope, so gradients are passed straight through.
# - Entries follow the vectors that choose them, by moving averages; dead ones begin again.
# - $G$ tables of $K$ entries name $K^G$ vectors with the memory and the search of one.
# - The price is a grid: for a fixed cloud whose channels hang together one table is better at equal bits. An encoder can learn to fit the grid.
# - 176 frames of face, body and hands become 22 x 4 codes, a text that a network can learn to write.
#
# **Limits.** What the codes lose is lost. Notebook 07 repairs some of it. And our tables know our corpus' gestures only.
#
# **Back:** [01 Motion and sound](01_motion_and_sound.ipynb). **Next:** notebook 06 predicts the codes from speech.
