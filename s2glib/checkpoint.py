"""Checkpoints: one safetensors file holds the tensors, the config and how they came about.

Paper:    -
Notebook: notebooks/09_disentanglement.ipynb
"""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, get_args, get_type_hints

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import load_file, save
from torch import Tensor, nn

FORMAT = "s2glib/1"
Model = TypeVar("Model", bound=nn.Module)


class Header(NamedTuple):
    """What stands before the tensors of a checkpoint."""

    model: str
    config: dict[str, Any]
    metadata: dict[str, Any]


def save_checkpoint(
    path: str | os.PathLike[str],
    model: nn.Module,
    config: object,
    *,
    metadata: Mapping[str, Any] | None = None,
    half: bool = False,
) -> None:
    """Write a model's parameters and buffers, its config and some notes into one file.

    The file appears whole or not at all; a missing folder is made.

    Args:
        path: where to write; an older file there is replaced.
        model: its class has a `config_class`.
        config: the `config_class` instance that the model was built from: a frozen dataclass of
            numbers, strings, None, tuples of these and further such dataclasses.
        metadata: anything that JSON can hold (recipe, seed, steps, figures); see `read_metadata`.
        half: store float32 tensors as float16, as shipped files do; loading gives float32 again,
            rounded to 11 bits.

    Raises:
        TypeError: if `config` is not the model's, or JSON cannot hold and return it.
        ValueError: if `half` and a value is too large for float16.
    """
    expected = _config_class(type(model))
    if type(config) is not expected:
        raise TypeError(
            f"{type(model).__name__} is configured by a {expected.__name__}, "
            f"got a {type(config).__name__}; save the config that the model was built from"
        )
    header = {
        "format": FORMAT,
        "model": type(model).__name__,
        "config": _config_to_json(config),
        "metadata": json.dumps(dict(metadata or {})),
    }
    tensors = {
        name: (_to_half(name, tensor) if half else tensor)
        .cpu()
        .clone(memory_format=torch.contiguous_format)
        for name, tensor in model.state_dict().items()
    }
    _write(Path(path), save(tensors, header))


def load_checkpoint(path: str | os.PathLike[str], model_class: type[Model]) -> Model:
    """Rebuild a saved model, on the CPU and in evaluation mode.

    torch's global random state is left as it was.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if the file is truncated, foreign, of another format version or model class,
            or if its config or its tensors do not fit the class.
    """
    header = _read_header(path)
    if header.model != model_class.__name__:
        raise ValueError(
            f"{path} holds a {header.model}, not a {model_class.__name__}; "
            f"load it as {header.model} or choose another file"
        )
    config_class = _config_class(model_class)
    try:
        config = _from_json(config_class, header.config)
        with torch.random.fork_rng(devices=[]):
            model = model_class(config)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"the config in {path} does not make a {config_class.__name__} ({error}); "
            "it was written by another version of s2glib"
        ) from error
    tensors = load_file(path)
    _check_tensors(path, tensors, model)
    model.load_state_dict(tensors)
    return model.eval()


def read_metadata(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the notes that were saved with a model, without building it.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if the file is truncated, foreign or of another format version.
    """
    return _read_header(path).metadata


def _config_class(model_class: type[nn.Module]) -> type[Any]:
    config_class = getattr(model_class, "config_class", None)
    if config_class is None:
        raise TypeError(f"{model_class.__name__} has no config_class; checkpoints need one")
    return config_class


def _config_to_json(config: Any) -> str:
    text = json.dumps(asdict(config))
    if _from_json(type(config), json.loads(text)) != config:
        raise TypeError(
            f"this {type(config).__name__} does not survive JSON: {config}; use only numbers, "
            "strings, None, tuples and dataclasses, each annotated as what it is"
        )
    return text


def _from_json(hint: Any, value: Any) -> Any:
    """Undo `asdict` and JSON: objects become the hinted dataclass, lists become tuples."""
    hints = get_args(hint) or (hint,)
    if isinstance(value, dict):
        config_class: Any = next((h for h in hints if is_dataclass(h)), None)
        if config_class is None:
            raise TypeError(f"{hint} cannot hold the fields {', '.join(value)}")
        known = get_type_hints(config_class)
        return config_class(**{k: _from_json(known.get(k), v) for k, v in value.items()})
    if isinstance(value, list):
        return tuple(map(_from_json, cycle(h for h in hints if h is not Ellipsis), value))
    return value


def _to_half(name: str, tensor: Tensor) -> Tensor:
    if tensor.dtype != torch.float32:
        return tensor
    half = tensor.half()
    if not torch.equal(half.isfinite(), tensor.isfinite()):
        raise ValueError(
            f"{name} reaches {tensor.abs().max():.3g}, and float16 only 65504; save with half=False"
        )
    return half


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        unfinished.write_bytes(content)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def _read_header(path: str | os.PathLike[str]) -> Header:
    if not os.path.isfile(path):
        raise FileNotFoundError(f"there is no checkpoint file at {path}; check the path")
    try:
        with safe_open(path, "pt") as file:
            header = file.metadata() or {}
    except SafetensorError as error:
        raise ValueError(
            f"{path} is not a whole safetensors file ({error}); "
            "it is truncated or something else: fetch or train it again"
        ) from error
    if header.get("format") != FORMAT:
        raise ValueError(
            f"{path} has the format {header.get('format')}, this s2glib reads {FORMAT}; "
            "install the version of s2glib that wrote it"
        )
    try:
        config, metadata = json.loads(header["config"]), json.loads(header["metadata"])
        return Header(header["model"], config, metadata)
    except (KeyError, ValueError) as error:
        raise ValueError(f"the header of {path} is damaged ({error}); fetch it again") from error


def _check_tensors(
    path: str | os.PathLike[str], tensors: Mapping[str, Tensor], model: nn.Module
) -> None:
    saved = {name: tuple(tensor.shape) for name, tensor in tensors.items()}
    wanted = {name: tuple(tensor.shape) for name, tensor in model.state_dict().items()}
    for name in sorted(saved.keys() | wanted.keys()):
        if saved.get(name) != wanted.get(name):
            raise ValueError(
                f"{name} has the shape {saved.get(name, 'missing')} in {path}, but "
                f"{wanted.get(name, 'missing')} in {type(model).__name__}; the two do not belong "
                "together"
            )
