import json
import os
from dataclasses import dataclass, replace

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.torch import load_file, save_file
from torch import nn

from s2glib.checkpoint import load_checkpoint, read_metadata, save_checkpoint


@dataclass(frozen=True)
class Block:
    width: int = 3
    dropout: float | None = None


@dataclass(frozen=True)
class NetConfig:
    name: str = "net"
    scale: float = 0.1
    sizes: tuple[int, ...] = (2, 3)
    blocks: tuple[Block, ...] = (Block(), Block(5, 0.5))
    first: Block = Block(7)
    spare: Block | None = None
    bias: bool = True


class Net(nn.Module):
    config_class = NetConfig

    def __init__(self, config: NetConfig) -> None:
        super().__init__()
        self.config = config
        self.linears = nn.ModuleList(nn.Linear(4, b.width, config.bias) for b in config.blocks)
        self.norm = nn.BatchNorm1d(config.first.width)
        self.register_buffer("table", torch.randn(config.sizes, dtype=torch.float64))


class OtherNet(Net):
    pass


@pytest.fixture
def net():
    torch.manual_seed(0)
    return Net(NetConfig())


@pytest.fixture
def saved(net, tmp_path):
    path = tmp_path / "net.safetensors"
    save_checkpoint(path, net, net.config, metadata={"recipe": "toy", "steps": 12, "wrist_cm": 1.5})
    return path


def assert_same_tensors(ours, theirs):
    theirs = theirs.state_dict()
    for name, tensor in ours.state_dict().items():
        assert tensor.dtype == theirs[name].dtype
        assert torch.equal(tensor, theirs[name]), name


def rewrite(path, tensors=None, **changes):
    """Write the same file with other tensors or other header entries; None drops an entry."""
    with safe_open(path, "pt") as file:
        header = {**file.metadata(), **changes}
    header = {key: value for key, value in header.items() if value is not None}
    save_file(load_file(path) if tensors is None else tensors, path, metadata=header)


def test_a_model_comes_back_with_parameters_buffers_and_config(net, saved):
    loaded = load_checkpoint(saved, Net)
    assert loaded.config == net.config
    assert not loaded.training
    assert_same_tensors(loaded, net)


words = st.text(max_size=5)
blocks = st.builds(Block, width=st.integers(1, 9), dropout=st.none() | st.floats(0, 1))
configs = st.builds(
    NetConfig,
    name=words,
    scale=st.floats(allow_nan=False),
    sizes=st.lists(st.integers(1, 3), max_size=3).map(tuple),
    blocks=st.lists(blocks, max_size=3).map(tuple),
    first=blocks,
    spare=st.none() | blocks,
    bias=st.booleans(),
)


@given(config=configs)
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_config_survives(config, tmp_path):
    path = tmp_path / "net.safetensors"
    save_checkpoint(path, Net(config), config)
    assert load_checkpoint(path, Net).config == config


def test_half_files_are_half_as_large_and_load_as_float32(tmp_path):
    config = NetConfig(blocks=(Block(1000),))
    net = Net(config)
    for half in (False, True):
        save_checkpoint(tmp_path / f"{half}", net, config, half=half)
    assert os.path.getsize(tmp_path / "True") < 0.6 * os.path.getsize(tmp_path / "False")
    loaded = load_checkpoint(tmp_path / "True", Net)
    for name, tensor in loaded.state_dict().items():
        original = net.state_dict()[name]
        assert tensor.dtype == original.dtype
        torch.testing.assert_close(tensor, original, rtol=2**-11, atol=2**-25)
    assert torch.equal(loaded.table, net.table)  # float64 is left alone


def test_values_too_large_for_half_are_refused(net, tmp_path):
    net.norm.running_var.fill_(1e5)
    with pytest.raises(ValueError, match=r"running_var reaches 1e\+05"):
        save_checkpoint(tmp_path / "net", net, net.config, half=True)
    assert not list(tmp_path.iterdir())


def test_metadata_is_read_without_the_model(net, saved, tmp_path):
    assert read_metadata(saved) == {"recipe": "toy", "steps": 12, "wrist_cm": 1.5}
    save_checkpoint(tmp_path / "bare", net, net.config)
    assert read_metadata(tmp_path / "bare") == {}


def test_loading_leaves_the_global_random_state_alone(saved):
    before = torch.get_rng_state()
    load_checkpoint(saved, Net)
    assert torch.equal(before, torch.get_rng_state())


def test_tied_and_transposed_tensors_are_saved_as_they_are(net, tmp_path):
    net.linears[0].weight = net.linears[1].weight = nn.Parameter(torch.ones(4, 3).T)
    config = replace(net.config, blocks=(Block(3), Block(3)))
    with torch.no_grad():
        net.linears[1].bias = nn.Parameter(torch.ones(3))
    save_checkpoint(tmp_path / "net", net, config)
    assert_same_tensors(load_checkpoint(tmp_path / "net", Net), net)


def test_another_class_is_refused_by_both_names(saved):
    with pytest.raises(ValueError, match=r"holds a Net, not a OtherNet"):
        load_checkpoint(saved, OtherNet)


def test_another_format_is_refused_by_both_names(saved):
    rewrite(saved, format="s2glib/99")
    for read in (lambda: load_checkpoint(saved, Net), lambda: read_metadata(saved)):
        with pytest.raises(ValueError, match=r"s2glib/99, this s2glib reads s2glib/1"):
            read()


@pytest.mark.parametrize("config", ['{"width": 3}', '{"scale": {"a": 1}}', "{"])
def test_a_config_of_another_version_is_refused(saved, config):
    rewrite(saved, config=config)
    with pytest.raises(ValueError, match=r"config|header"):
        load_checkpoint(saved, Net)


def test_fields_that_were_added_since_take_their_defaults(net, saved):
    config = json.dumps({"blocks": [{"width": 3}, {"width": 5, "dropout": 0.5}]})
    rewrite(saved, config=config)
    assert load_checkpoint(saved, Net).config == net.config


@pytest.mark.parametrize("change", ["missing", "surplus", "shape"])
def test_tensors_that_do_not_fit_are_refused_by_name(saved, change):
    tensors = load_file(saved)
    weight = tensors.pop("linears.0.weight")
    if change == "surplus":
        tensors |= {"linears.0.weight": weight, "linears.0.wait": weight.clone()}
    elif change == "shape":
        tensors["linears.0.weight"] = weight[:2].clone()
    rewrite(saved, tensors)
    with pytest.raises(ValueError, match=r"linears\.0\.w.* in Net"):
        load_checkpoint(saved, Net)


@given(share=st.floats(0, 1, exclude_max=True))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_truncated_file_is_refused_wherever_it_ends(saved, share):
    content = saved.read_bytes()
    cut = saved.with_name("cut.safetensors")
    cut.write_bytes(content[: int(share * len(content))])
    for read in (lambda: load_checkpoint(cut, Net), lambda: read_metadata(cut)):
        with pytest.raises(ValueError, match=r"cut\.safetensors is not a whole"):
            read()


@pytest.mark.parametrize("content", [b"", b"some text, no tensors", b"PK\x03\x04" + bytes(99)])
def test_a_foreign_file_is_refused(tmp_path, content):
    path = tmp_path / "net.safetensors"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="truncated or something else"):
        load_checkpoint(path, Net)


def test_someone_elses_safetensors_file_is_refused(tmp_path):
    save_file({"weight": torch.ones(3)}, tmp_path / "net.safetensors")
    with pytest.raises(ValueError, match="format None"):
        load_checkpoint(tmp_path / "net.safetensors", Net)


@pytest.mark.parametrize("entry", ["model", "config", "metadata"])
def test_a_header_without_an_entry_is_refused(saved, entry):
    rewrite(saved, **{entry: None})
    with pytest.raises(ValueError, match=f"header.*{entry}"):
        load_checkpoint(saved, Net)


@pytest.mark.parametrize("name", ["absent.safetensors", "."])
def test_a_missing_file_is_refused(tmp_path, name):
    with pytest.raises(FileNotFoundError, match="no checkpoint file"):
        load_checkpoint(tmp_path / name, Net)


@pytest.mark.parametrize(
    "config", [Block(), None, NetConfig(sizes=[1, 2]), NetConfig(scale=float("nan"))]
)
def test_a_config_that_could_not_come_back_is_refused(net, tmp_path, config):
    with pytest.raises(TypeError, match=r"configured by|does not survive"):
        save_checkpoint(tmp_path / "net", net, config)


def test_metadata_that_json_cannot_hold_is_refused(net, tmp_path):
    with pytest.raises(TypeError, match="JSON"):
        save_checkpoint(tmp_path / "net", net, net.config, metadata={"loss": np.ones(3)})


def test_a_class_without_a_config_is_refused(saved):
    with pytest.raises(TypeError, match="no config_class"):
        save_checkpoint(saved, nn.Linear(2, 2), NetConfig())


def test_a_failed_write_leaves_the_old_file_and_no_other(net, saved, monkeypatch):
    content = saved.read_bytes()

    def no_space(*_):
        raise OSError("no space left on device")

    monkeypatch.setattr(os, "replace", no_space)
    with pytest.raises(OSError, match="no space"):
        save_checkpoint(saved, net, net.config)
    assert saved.read_bytes() == content
    assert list(saved.parent.iterdir()) == [saved]


def test_a_missing_folder_is_made(net, tmp_path):
    path = tmp_path / "new" / "folder" / "net.safetensors"
    save_checkpoint(str(path), net, net.config)
    assert_same_tensors(load_checkpoint(str(path), Net), net)
