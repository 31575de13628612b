from itertools import pairwise

import matplotlib.pyplot as plt
import pytest
import torch
from stand_in import capsule_body, tone
from stand_in_probtalk import small_probtalk

from s2glib.audio import Waveform
from s2glib.papers.probtalk import remask_counts
from s2glib.widgets import Player, UnmaskingStepper
from s2glib.widgets.unmasking_stepper import expected_motion, unmask


@pytest.fixture(scope="module")
def probtalk():
    return small_probtalk()


@pytest.fixture
def stepper(probtalk):
    return UnmaskingStepper(probtalk, tone(3.0), capsule_body(), speaker=2)


@pytest.fixture(scope="module")
def asked(probtalk):
    nothing = torch.zeros(176, 4, dtype=torch.bool)
    return probtalk.ask(tone(3.0), 176, None, nothing, 2)


def seeded(number):
    return torch.Generator().manual_seed(number)


def memory_of(probtalk, asked):
    return probtalk.predictor.listen(asked.speech, asked.given, asked.known)


def package_codes(probtalk, asked, steps, seed):
    """Every state of the package's own decoding."""
    decoding = probtalk.predictor.decode(
        memory_of(probtalk, asked),
        asked.speaker,
        unheard=memory_of(probtalk, asked._replace(speech=0 * asked.speech)),
        guidance=probtalk.predictor.config.guidance,
        steps=steps,
        generator=seeded(seed),
    )
    return [state.codes[0] for state in decoding]


def test_it_begins_with_nothing_known(stepper):
    assert not stepper.state.known.any()
    assert "all 88 tokens are hidden" in stepper.told.value
    assert (stepper.step.value, stepper.step.max) == (0, 8)


def test_its_states_are_those_of_the_packages_decoding(stepper, probtalk, asked):
    stepper.choose(steps=5, draw=3)
    expected = package_codes(probtalk, asked, steps=5, seed=3)
    assert len(stepper.states) == 6
    for state, codes in zip(stepper.states[1:], expected, strict=True):
        assert torch.equal(state.codes, codes)


@pytest.mark.parametrize("steps", [1, 8])
def test_known_tokens_grow_by_the_new_ones(probtalk, asked, steps):
    states = unmask(probtalk, asked, steps=steps, generator=seeded(0))
    hidden = [int((~state.known).sum()) for state in states]
    assert hidden == [88, *remask_counts(88, steps)]
    for before, after in pairwise(states):
        assert torch.equal(after.known & ~before.known, after.new)
        assert torch.equal(after.log_p[before.known], before.log_p[before.known])
        assert torch.equal(after.log_p.isnan(), ~after.known)


def test_probabilities_are_those_that_a_code_was_drawn_with(probtalk, asked):
    states = unmask(probtalk, asked, steps=4, generator=seeded(0))
    shown = states[1].codes[None]
    with torch.no_grad():
        heard = probtalk.predictor.predict(memory_of(probtalk, asked), asked.speaker, shown)
        deaf = asked._replace(speech=0 * asked.speech)
        unheard = probtalk.predictor.predict(memory_of(probtalk, deaf), asked.speaker, shown)
    odds = (3.0 * heard - 2.0 * unheard)[0]
    state = states[2]
    for t, g in state.new.nonzero().tolist():
        expected = odds[t, g].log_softmax(-1)[state.codes[t, g]]
        assert state.log_p[t, g] == pytest.approx(expected.item(), abs=1e-4)


def test_the_last_state_moves_as_its_codes_say(probtalk, asked):
    last = unmask(probtalk, asked, steps=3, generator=seeded(0))[-1]
    with torch.no_grad():
        track = probtalk.pqvae.decode(last.codes[None])[0]
    torch.testing.assert_close(last.motion.poses, probtalk.pqvae.features.to_poses(track))
    torch.testing.assert_close(last.motion.expression, probtalk.pqvae.features.to_expression(track))


def test_a_hidden_token_is_the_mean_of_what_is_expected(probtalk):
    pqvae, codes = probtalk.pqvae, torch.randint(6, (1, 22, 4), generator=seeded(0))
    log_p = torch.full((1, 22, 4, 6), -torch.inf)
    log_p[..., :2] = torch.tensor([0.25, 0.75]).log()
    codes[0, 7, 2] = 6  # hidden
    with torch.no_grad():
        found = expected_motion(pqvae, codes, log_p)
        first, second = (codes.where(codes < 6, torch.tensor(k)) for k in (0, 1))
        vectors = 0.25 * pqvae.quantizer.decode(first) + 0.75 * pqvae.quantizer.decode(second)
        torch.testing.assert_close(found, pqvae.from_latents(vectors))


def test_a_step_shows_its_body_and_says_how_many_are_known(stepper):
    stepper.go(3)
    expected = Player(stepper.states[3].motion, tone(176 / 30), capsule_body())
    assert stepper.player.motion == expected.motion
    assert "Step 3 of 8: 15 of 88 tokens are known, 8 of them new" in stepper.told.value
    assert "73 were drawn and hidden again" in stepper.told.value


def test_buttons_go_on_and_back_and_stop_at_the_end(stepper):
    for _ in range(10):
        stepper.next.click()
    assert stepper.step.value == 8
    assert stepper.state.known.all()
    stepper.again.click()
    assert stepper.step.value == 0


def test_fewer_steps_than_the_one_that_is_shown_show_the_last(stepper):
    stepper.go(8)
    stepper.choose(steps=2, draw=1)
    assert (stepper.step.value, stepper.step.max) == (2, 2)
    assert stepper.state.known.all()
    assert "Step 2 of 2" in stepper.told.value


def test_another_draw_decodes_anew_at_the_same_step(stepper):
    stepper.go(8)
    before = stepper.state.codes
    stepper.choose(steps=8, draw=2)
    assert stepper.step.value == 8
    assert not torch.equal(stepper.state.codes, before)
    stepper.choose(steps=8, draw=1)
    assert torch.equal(stepper.state.codes, before)


def test_of_longer_speech_the_first_window_is_heard(probtalk, asked):
    long = tone(9.0)
    stepper = UnmaskingStepper(probtalk, long, capsule_body(), speaker=2)
    seconds = 176 / 30
    cut = Waveform(long.samples[: round(16000 * seconds)], 16000)
    expected = Player(stepper.state.motion, cut, capsule_body())
    assert stepper.player.sound == expected.sound
    assert stepper.player.frames == 176


def test_without_a_kernel_the_table_is_drawn(stepper):
    stepper.go(2)
    fig, axes = plt.subplots()
    assert stepper.draw(axes) is axes
    assert (~axes.images[0].get_array().mask).sum() == 7
    assert len(axes.patches) == 5
    plt.close(fig)


def test_its_words_never_change(stepper):
    before = repr(stepper)
    stepper.go(4)
    assert repr(stepper) == before
    assert before.startswith("UnmaskingStepper")


@pytest.mark.usefixtures("without_type_hook")
def test_what_does_not_fit_is_told(probtalk):
    body = capsule_body()
    with pytest.raises(TypeError, match="must be a ProbTalk, got Predictor"):
        UnmaskingStepper(probtalk.predictor, tone(), body)
    with pytest.raises(TypeError, match="speech comes as a Waveform"):
        UnmaskingStepper(probtalk, tone().samples, body)
    with pytest.raises(ValueError, match="numbered 0 to 23, got 24"):
        UnmaskingStepper(probtalk, tone(), body, speaker=24)
