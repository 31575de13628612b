"""Where films of one's own may be trained on."""

import pytest

from s2glib.__main__ import main
from s2glib.commands.train import STAGES, TAKES_DATA


@pytest.mark.parametrize("stage", sorted(STAGES.keys() - set(TAKES_DATA)))
def test_stages_of_the_corpus_refuse_other_data(here, capsys, stage):
    assert main(["train", stage, "--data", "films"]) == 2
    assert capsys.readouterr().err == (
        f"s2glib train: {stage} trains on the corpus only; leave out --data, which is for "
        "mddiffusion-decoupling and mddiffusion-refinement\n"
    )
    assert not list(here.iterdir())


def test_a_folder_that_is_not_there(here, capsys):
    assert main(["train", "mddiffusion-decoupling", "--data", "films"]) == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert sentence.endswith("there is no folder of films at films; check the path")
    assert not list(here.iterdir())
