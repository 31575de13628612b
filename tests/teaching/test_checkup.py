import importlib.metadata

import pytest
import torch

from s2glib.body import Motion
from s2glib.papers.amuse import Amuse
from s2glib.teaching import check_environment, checkup


def works():
    pass


def fails():
    raise RuntimeError("a gradient is wrong")


def test_each_part_gets_a_line_and_a_fault_its_cure(capsys):
    assert check_environment({"sound": (works, "unused")})
    assert capsys.readouterr().out == "sound     works\nEverything works.\n"
    assert not check_environment({"learning": (fails, "run it again"), "sound": (works, "")})
    first, second, last = capsys.readouterr().out.splitlines()
    assert first == "learning  DOES NOT WORK (a gradient is wrong): run it again"
    assert (second, last) == ("sound     works", "Mend the lines in capitals.")


@pytest.mark.parametrize("name", ["packages", "widgets", "sound", "learning", "body", "networks"])
def test_a_part_of_this_set_up_works(name):
    assert check_environment({name: checkup.PARTS[name]})


def test_an_old_package_is_found(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "0.0.1")
    with pytest.raises(RuntimeError, match="too old"):
        checkup.check_packages()


def test_a_missing_extension_is_found(monkeypatch):
    monkeypatch.setattr(checkup, "EXTENSIONS", ("no-such-extension",))
    with pytest.raises(RuntimeError, match="no-such-extension"):
        checkup.check_widgets()


def test_networks_that_hold_a_body_still_are_found(monkeypatch):
    def stand(amuse, heard, *, generator):
        return Motion(torch.zeros(9, 55, 3), torch.zeros(9, 3), torch.zeros(9, 100), 30)

    monkeypatch.setattr(Amuse, "gesture", stand)
    with pytest.raises(RuntimeError, match=r"0\.00 m/s"):
        checkup.check_networks()


@pytest.mark.parametrize("name", ["clips", "body", "networks"])
def test_missing_data_are_found(name, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("S2G_DATA", str(tmp_path))
    assert not check_environment({name: checkup.PARTS[name]})
    assert checkup.RESTORE in capsys.readouterr().out
