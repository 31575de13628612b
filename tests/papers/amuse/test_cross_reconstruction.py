import pytest
import torch
from torch.nn import functional as F

from s2glib.papers.amuse import (
    Donors,
    SpeechLatents,
    factor_swap_losses,
    latent_reliance,
    quadruple_losses,
    swap_partner,
)


def partner_along_content(k):
    return (6 - k) % 4 + 1  # [AM B.4], emotion and style swaps


def partner_along_style(k):
    return (1 + k) % 4 + 1  # [AM B.4], content swap


PARTNER = {"content": partner_along_content, "style": partner_along_style}


@pytest.mark.parametrize("axis", PARTNER)
def test_partners_are_the_papers_j_of_k(axis):
    latents = torch.arange(4.0)[:, None]
    assert swap_partner(latents, axis).flatten().tolist() == [
        PARTNER[axis](k) - 1 for k in (1, 2, 3, 4)
    ]


@pytest.mark.parametrize("axis", PARTNER)
def test_a_swap_undoes_itself_and_keeps_batches_apart(axis):
    latents = torch.randn(4, 3, 2, 5)
    swapped = swap_partner(latents, axis)
    assert torch.equal(swap_partner(swapped, axis), latents)
    assert torch.equal(swapped[:, 1], swap_partner(latents[:, 1], axis))


def test_partners_share_what_a_swap_may_exchange():
    clips = [(content, style) for style in (1, 2) for content in (1, 2)]  # a1 .. a4
    for k, (content, style) in enumerate(clips, start=1):
        assert clips[partner_along_content(k) - 1] == (3 - content, style)
        assert clips[partner_along_style(k) - 1] == (content, 3 - style)


@pytest.mark.usefixtures("without_type_hook")
def test_clips_of_a_quadruple_share_one_emotion():
    with pytest.raises(ValueError, match="'emotion'"):
        swap_partner(torch.zeros(4, 1), "emotion")


def slow_losses(model, a, emotion, style):
    """The seven terms for one quadruple, clip by clip, as B.4 prints them; k counts from 1."""
    e_c, e_s, e_e = model.content_encoder, model.style_encoder, model.emotion_encoder

    def drawn(c, s, e):
        return model.decode(SpeechLatents(e_c(a[c]), e_e(a[e]), e_s(a[s])))

    quadruple = {k: a[k] for k in (1, 2, 3, 4)}
    l_self = sum((drawn(k, k, k) - x).abs().sum() for k, x in quadruple.items())
    j = partner_along_content
    l_xemo = sum((drawn(k, k, j(k)) - x).abs().sum() for k, x in quadruple.items())
    l_xsty = sum((drawn(k, j(k), k) - x).abs().sum() for k, x in quadruple.items())
    j = partner_along_style
    l_xcon = sum((drawn(j(k), k, k) - x).abs().sum() for k, x in quadruple.items())
    l_con = sum((e_c(a[k]) - e_c(a[k + 2])).abs().sum() for k in (1, 2))
    l_emo = sum(-model.emotion_head(e_e(x)).log_softmax(-1)[0, emotion] for x in quadruple.values())
    l_sty = sum(
        -model.style_head(e_s(x)).log_softmax(-1)[0, style[k - 1]] for k, x in quadruple.items()
    )
    return l_self, l_xcon, l_xemo, l_xsty, l_con, l_emo, l_sty


def test_the_seven_losses_agree_with_a_loop_over_the_papers_formulas(speech):
    """Ours are means over the clips of a quadruple; L_con has two of them."""
    clips = torch.randn(4, 1, 352, 64)
    style = torch.tensor([[1], [1], [3], [3]])
    losses = quadruple_losses(speech, clips, torch.tensor([2]), style, reduction="sum")
    numbered = {k: clips[k - 1] for k in (1, 2, 3, 4)}
    slow = slow_losses(speech, numbered, 2, style.flatten().tolist())
    for name, ours, printed, count in zip(
        losses._fields, losses, slow, (4, 4, 4, 4, 2, 4, 4), strict=True
    ):
        torch.testing.assert_close(ours * count, printed, msg=name, rtol=1e-4, atol=1e-4)


def test_means_are_sums_over_their_elements(speech):
    clips, style = torch.randn(4, 2, 352, 64), torch.tensor([[0, 1]] * 4)
    emotion = torch.tensor([0, 7])
    mean, total = (
        quadruple_losses(speech, clips, emotion, style, reduction=r) for r in ("mean", "sum")
    )
    torch.testing.assert_close(torch.stack(mean[:4]) * 352 * 64, torch.stack(total[:4]))
    torch.testing.assert_close(mean.content * 64, total.content)
    torch.testing.assert_close(mean.total(), sum(mean) - mean.content / 2)
    torch.testing.assert_close(mean.total(content=0.0, classification=0.0), sum(mean[:4]))


def test_encoders_may_hear_something_else_than_what_is_drawn(speech):
    clips, style = torch.randn(4, 1, 352, 64), torch.tensor([[0], [0], [1], [1]])
    plain = quadruple_losses(speech, clips, torch.tensor([1]), style)
    heard = quadruple_losses(speech, clips, torch.tensor([1]), style, heard=torch.zeros_like(clips))
    assert heard.content == 0  # the same silence four times
    assert heard.self_reconstruction == heard.cross_style == heard.cross_emotion
    assert plain.content > 0


def swap_batch(speech):
    donors = Donors(*(torch.randn(3, 352, 64) for _ in range(3)))
    return torch.randn(3, 352, 64), donors, torch.tensor([0, 3, 7]), torch.tensor([0, 1, 4])


def test_the_full_factor_swap_takes_each_latent_from_its_donor(speech):
    target, donors, emotion, style = swap_batch(speech)
    losses = factor_swap_losses(speech, target, donors, emotion, style, cycle=False)
    e = speech.emotion_encoder(donors.emotion)
    s = speech.style_encoder(donors.style)
    drawn = speech.decode(SpeechLatents(speech.content_encoder(donors.content), e, s))
    torch.testing.assert_close(losses.reconstruction, F.l1_loss(drawn, target))
    torch.testing.assert_close(losses.emotion, F.cross_entropy(speech.emotion_head(e), emotion))
    torch.testing.assert_close(losses.style, F.cross_entropy(speech.style_head(s), style))
    assert losses.cycle == 0


def test_the_cycle_trains_the_drawing_and_not_the_judge(speech):
    speech.train()
    target, donors, emotion, style = swap_batch(speech)
    losses = factor_swap_losses(speech, target, donors, emotion, style, cycle=True)
    losses.cycle.backward()
    assert all(p.grad is None for p in speech.emotion_head.parameters())
    assert all(p.grad is None for p in speech.style_head.parameters())
    assert speech.decoder.out.weight.grad.abs().max() > 0
    assert all(p.requires_grad for p in speech.parameters())
    assert all(module.training for module in speech.modules())


def test_reliance_is_the_error_with_a_latent_of_the_neighbour(speech):
    clips = torch.randn(3, 352, 64)
    errors = latent_reliance(speech, clips)
    with torch.no_grad():
        c, e, s = speech.encode(clips)
        self_error = (speech(clips) - clips).abs().mean()
        wrong_style = speech.decode(SpeechLatents(c, e, s[[2, 0, 1]]))
    assert errors["self"] == pytest.approx(float(self_error), rel=1e-5)
    assert errors["style"] == pytest.approx(float((wrong_style - clips).abs().mean()), rel=1e-5)
    assert set(errors) == {"self", "content", "emotion", "style"}
