"""The locks, pyproject.toml and environment.yml say the same thing, exactly."""

import importlib.metadata
import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
LOCKS = ("requirements.lock", "requirements-dev.lock")
PIN = re.compile(r"[A-Za-z0-9._-]+==[A-Za-z0-9.]+")  # no local tag, path, marker or option


def read_lock(text: str) -> dict[str, str]:
    """Map canonical names to versions; ValueError names a line that is no exact pin."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    loose = [line for line in lines if not PIN.fullmatch(line)]
    if loose:
        raise ValueError(f"not exact pins: {loose}")
    pins = [line.split("==") for line in lines]
    return {canonicalize_name(name): version for name, version in pins}


def lock_of(name: str) -> dict[str, str]:
    return read_lock((ROOT / name).read_text())


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def unmet(requirements: list[str], pins: dict[str, str]) -> list[str]:
    """The requirements that the pins do not satisfy."""
    gaps = []
    for wanted in map(Requirement, requirements):
        version = pins.get(canonicalize_name(wanted.name))
        if version is None or not wanted.specifier.contains(version, prereleases=True):
            gaps.append(str(wanted))
    return gaps


def missing_beneath(pins: dict[str, str]) -> list[str]:
    """What the pinned packages need on this machine and the pins leave open."""
    gaps = []
    for name in sorted(pins.keys() - {"torch"}):  # its needs differ between CPU and CUDA builds
        for text in importlib.metadata.requires(name) or []:
            wanted = Requirement(text)
            applies = wanted.marker is None or wanted.marker.evaluate({"extra": ""})
            if applies and canonicalize_name(wanted.name) not in pins:
                gaps.append(f"{name} needs {wanted.name}")
    return gaps


def test_the_readers_lock_satisfies_the_project():
    assert unmet(project()["dependencies"], lock_of("requirements.lock")) == []


def test_the_dev_lock_satisfies_the_project_with_all_extras():
    extras = project()["optional-dependencies"]
    wanted = [*project()["dependencies"], *(text for extra in extras.values() for text in extra)]
    assert unmet(wanted, lock_of("requirements-dev.lock")) == []


@pytest.mark.parametrize("extra", ["corpus", "video", "pretrained", "bench", "dev"])
def test_readers_install_no_extra(extra):
    named = {
        canonicalize_name(Requirement(t).name) for t in project()["optional-dependencies"][extra]
    }
    beneath = {"pytest"}  # nbval needs it
    assert named & lock_of("requirements.lock").keys() <= beneath


def test_the_dev_lock_holds_the_readers_lock():
    assert lock_of("requirements.lock").items() <= lock_of("requirements-dev.lock").items()


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_leaves_nothing_open(lock):
    assert missing_beneath(lock_of(lock)) == []


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_pins_neither_the_package_itself_nor_both_pyworlds(lock):
    assert lock_of(lock).keys().isdisjoint({"s2glib", "pyworld"})


def test_what_is_installed_is_what_is_locked():
    pins = lock_of("requirements-dev.lock")
    installed = {name: importlib.metadata.version(name).split("+")[0] for name in pins}
    assert installed == pins


def test_conda_installs_the_readers_lock():
    conda = yaml.safe_load((ROOT / "environment.yml").read_text())["dependencies"]
    (pip,) = (entry["pip"] for entry in conda if isinstance(entry, dict))
    index = "--extra-index-url https://download.pytorch.org/whl/cpu"
    assert pip == [index, "-r requirements.lock", "-e ."]
    python = next(entry for entry in conda if str(entry).startswith("python"))
    assert python.split("=")[1] in project()["requires-python"]


@pytest.mark.parametrize(
    "line", ["torch==2.13.0+cpu", "numpy>=2", "-e .", "s2glib @ file:///somewhere", "numpy", ""]
)
def test_a_loose_line_in_a_lock_is_refused(line):
    with pytest.raises(ValueError, match="not exact pins"):
        read_lock(f"# comment\nscipy==1.17.1\n{line}\n")


def test_an_unmet_range_and_a_gap_are_found():
    assert unmet(["numpy>=2", "scipy"], {"numpy": "1.26"}) == ["numpy>=2", "scipy"]
    assert "pytest needs pluggy" in missing_beneath({"pytest": "9"})
