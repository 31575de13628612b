import json

import pytest

from s2glib.recipes import evaluate as module
from s2glib.recipes.evaluate import evaluate
from s2glib.recipes.report import Row

GOOD, MISSED = Row("EA", 0.99, 672, (0.98, 1.0)), Row("EA", 0.96, 672, (0.95, 0.97))
BELOW = Row("wrist speed, anger / sadness, generated", 1.2, 80, (1.1, 1.3))


@pytest.fixture
def measured(monkeypatch):
    """Say what the tables will hold."""

    def tables(speech, gesture=(), recorded=()):
        monkeypatch.setitem(module.TABLES, "amuse-speech", lambda folder: list(speech))
        monkeypatch.setitem(module.TABLES, "amuse-gesture", lambda folder: list(gesture))
        monkeypatch.setitem(module.TABLES, "mddiffusion-video", lambda folder: [])
        monkeypatch.setitem(module.RECORDED, "mddiffusion-video", lambda runs: list(recorded))
        monkeypatch.setitem(module.TABLES, "probtalk", lambda folder: [])
        monkeypatch.setitem(module.RECORDED, "probtalk", lambda runs: [])
        monkeypatch.setitem(module.VERDICTS, "probtalk", lambda runs: "Who wins.")

    return tables


@pytest.mark.parametrize(
    ("row", "strict", "code"),
    [(GOOD, True, 0), (MISSED, True, 1), (BELOW, True, 1), (MISSED, False, 0), (BELOW, False, 0)],
)
def test_only_strict_fails_and_only_where_something_is_missed(measured, capsys, row, strict, code):
    measured([row])
    assert evaluate("amuse-speech", strict=strict) == code
    assert row.name in capsys.readouterr().out


def test_all_is_every_table_in_one_file(measured, tmp_path):
    measured([GOOD], [BELOW])
    assert evaluate("all", json_path=tmp_path / "all.json") == 0
    rows = json.loads((tmp_path / "all.json").read_text())
    assert [row["name"] for row in rows] == [GOOD.name, BELOW.name]
    assert rows[0]["met"] is True


def test_a_verdict_follows_its_table(measured, capsys):
    measured([GOOD])
    evaluate("all")
    assert capsys.readouterr().out.splitlines()[-1] == "Who wins."
    evaluate("amuse-speech")
    assert "Who wins." not in capsys.readouterr().out


def test_without_the_corpus_extra_it_says_so_in_one_line_and_writes_nothing(
    monkeypatch, capsys, tmp_path
):
    def lacking(folder):
        raise ImportError("No module named 'pyworld'")

    monkeypatch.setitem(module.TABLES, "amuse-speech", lacking)
    assert evaluate("amuse-speech", json_path=tmp_path / "rows.json") == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert "s2glib[corpus]" in said.err
    assert not said.out
    assert not list(tmp_path.iterdir())


def test_an_unknown_table_is_refused_by_naming_the_known_ones():
    with pytest.raises(
        ValueError, match="amuse-gesture, mddiffusion-video, probtalk, all; got 'amuse'"
    ):
        evaluate("amuse")


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("amuse-speech", "amuse-disentangler"),
        ("amuse-gesture", "amuse-disentangler"),
        ("mddiffusion-video", "mddiffusion-decoupling"),
        ("probtalk", "probtalk-pqvae"),
    ],
)
def test_a_missing_checkpoint_is_named(name, missing, tmp_path):
    with pytest.raises(FileNotFoundError, match=missing):
        evaluate(name, folder=tmp_path)


def test_recorded_rows_say_so(measured, capsys):
    measured([], recorded=[GOOD._replace(recorded=True)])
    evaluate("mddiffusion-video")
    assert "(recorded)" in capsys.readouterr().out


@pytest.mark.parametrize("table", module.STUDIES)
def test_recorded_runs_can_be_done_again(measured, monkeypatch, tmp_path, table):
    measured([])
    monkeypatch.setenv("S2G_CACHE", str(tmp_path / "cache"))
    shipped = tmp_path / "shipped"
    shipped.mkdir()
    (shipped / "begin.safetensors").write_bytes(b"here")
    trained, read, studies = [], [], module.STUDIES[table]
    for study in studies.values():
        monkeypatch.setattr(study, "train", trained.append)
    monkeypatch.setitem(module.RECORDED, table, lambda runs: read.append(runs) or [GOOD])
    evaluate(table, retrain=True, folder=shipped)
    expected = [(name, seed) for name, study in studies.items() for seed in study.SEEDS]
    assert [(stage.name, stage.seed) for stage in trained] == expected
    assert read == [trained[0].folder / "runs"]
    assert tmp_path / "cache" in read[0].parents
    assert (trained[0].folder / "checkpoints" / "begin.safetensors").read_bytes() == b"here"
