"""Where films of one's own may be trained on."""

import pytest

from s2glib.__main__ import main
from s2glib.commands.train import STAGES, TAKES_DATA


@pytest.mark.parametrize("stage", sorted(STAGES.keys() - set(TAKES_DATA)))
def test_stages_of_the_corpus_refuse_other_data(here, capsys, stage):
    assert main(["train", stage, "--data", "films"]) == 2
    assert capsys.readouterr().err == (
        f"s2glib train: {stage} trains on the corpus only; leave out --data, which is for "
        "mddiffusion-decoupling, mddiffusion-refinement, mddiffusion-128\n"
    )
    assert not list(here.iterdir())


def test_a_folder_that_is_not_there(here, capsys):
    assert main(["train", "mddiffusion-decoupling", "--data", "films"]) == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert sentence.endswith("there is no folder of films at films; check the path")
    assert not list(here.iterdir())


@pytest.mark.parametrize("wrong", [("--steps", "0"), ("--steps", "-3"), ("--seed", "-1")])
def test_no_steps_and_no_seed_are_refused(capsys, wrong):
    with pytest.raises(SystemExit) as left:
        main(["train", "mddiffusion-decoupling", *wrong])
    assert left.value.code == 2
    assert wrong[0] in capsys.readouterr().err
