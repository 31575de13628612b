import json
import subprocess
import sys
from importlib.resources import files

import pytest

from s2glib.__main__ import main

PRINTED = json.loads((files("s2glib.papers.amuse") / "printed.json").read_text("utf-8"))


def table(where):
    return next(each["rows"] for each in PRINTED["tables"] if each["where"] == where)


def said(what):
    return next(each["value"] for each in PRINTED["statements"] if each["what"] == what)


def test_help_names_the_commands_and_loads_no_torch():
    code = "import sys; from s2glib.__main__ import build_parser as b; b(); print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "s2glib.commands.swap" in loaded.stdout.split()
    assert not {"torch", "numpy", "librosa"} & set(loaded.stdout.split())


def test_help_names_the_commands(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    printed = capsys.readouterr().out
    assert all(f"\n    {name} " in printed for name in ("swap", "generate", "papers"))


def test_papers_prints_every_number_with_the_digits_of_the_paper(capsys):
    assert main(["papers"]) == 0
    printed = capsys.readouterr().out.split()
    assert {"96.060", "0.3740", "987.90", "1.10", "5.71", "118"} <= set(printed)
    rows = [row for each in PRINTED["tables"] for row in each["rows"].values()]
    numbers = {value for row in rows for value in row} | {
        each["value"] for each in PRINTED["statements"]
    }
    shown = {float(word) for word in printed if word.replace(".", "", 1).isdigit()}
    assert numbers - {None} <= shown


def test_every_table_is_a_rectangle():
    for each in PRINTED["tables"]:
        assert {len(row) for row in each["rows"].values()} == {len(each["columns"])}


def test_what_the_paper_prints_twice_is_the_same():
    ablation = table("Tab. A.3")
    assert ablation["Ours"][2:4] == table("Tab. A.4")["Ours"]
    assert ablation["Ours"][4] == said("GA, AMUSE")
    assert ablation["GT"][4] == said("GA, GT")


def test_preferences_leave_room_for_the_indifferent():
    shares = table("Tab. A.5").values()
    assert all(sum(row[:2]) <= 100 and sum(row[2:]) <= 100 for row in shares)
