"""Whether two answers are the same, and if not, where they differ, in a few words.

Paper:    -
Notebook: -
"""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from numbers import Number

import numpy as np
from torch import Tensor

from s2glib.teaching.showing import spoken

FEW = 9  # numbers that are worth printing


def difference(expected: object, got: object, tolerance: float, name: str = "answer") -> str | None:
    """Say where `got` is not `expected`; None if it is the same.

    Tuples are compared item by item, whether named or not, and dataclasses field by field; arrays
    in kind, shape, dtype and values, where nan equals nan.

    Args:
        expected: what is right.
        got: what came.
        tolerance: relative and absolute error of numbers that is forgiven.
        name: how to speak of `got`.
    """
    inside, found = _parts(expected), _parts(got)
    if inside is not None:
        alike = type(expected) is type(got) or not is_dataclass(expected)
        if found is None or not alike or len(found) != len(inside):
            return f"{name} should be {brief(expected)}, yours is {brief(got)}"
        parts = zip(inside.items(), found.values(), strict=True)
        said = (difference(e, g, tolerance, f"{name}.{part}") for (part, e), g in parts)
        return next(filter(None, said), None)
    if isinstance(expected, Tensor | np.ndarray):
        return _array_difference(expected, got, tolerance, name)
    numbers = isinstance(expected, Number) and isinstance(got, Number)
    same = _close(expected, got, tolerance) if numbers else _equal(expected, got)
    return None if same else f"{name} should be {brief(expected)}, yours is {brief(got)}"


def arrays(value: object) -> Iterator[np.ndarray]:
    """All arrays in a value, those inside tuples and dataclasses too."""
    if isinstance(value, Tensor | np.ndarray):
        yield _as_numpy(value)
    for part in (_parts(value) or {}).values():
        yield from arrays(part)


def brief(value: object) -> str:
    """A value in a few words: small arrays as numbers, large ones by their shape."""
    if isinstance(value, Tensor | np.ndarray):
        kind = "tensor" if isinstance(value, Tensor) else "array"
        size = int(np.prod(value.shape))
        return spoken(value) if size <= FEW else f"{kind} of shape {tuple(value.shape)}"
    inside = _parts(value)
    if inside is not None and is_dataclass(value):
        said = ", ".join(f"{name}: {brief(part)}" for name, part in inside.items())
        return f"{type(value).__name__}({said})"
    if inside is not None and len(inside) <= FEW:
        return "(" + ", ".join(map(brief, inside.values())) + ")"
    if inside is not None:
        return f"{type(value).__name__} of {len(inside)}"
    text = " ".join(spoken(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def _parts(value: object) -> dict[str, object] | None:
    """What a tuple, list or dataclass is made of, by name; None for anything else."""
    if is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, tuple | list):
        names = getattr(value, "_fields", range(len(value)))
        return dict(zip(map(str, names), value, strict=True))
    return None


def _array_difference(
    expected: Tensor | np.ndarray, got: object, tolerance: float, name: str
) -> str | None:
    if not isinstance(got, Tensor | np.ndarray) or _kind(expected) != _kind(got):
        return f"{name} should be {_kind(expected)}, yours is {_kind(got)}"
    if expected.shape != got.shape:
        return f"{name} should have shape {tuple(expected.shape)}, yours has {tuple(got.shape)}"
    if expected.dtype != got.dtype:
        return f"{name} should hold {expected.dtype}, yours holds {got.dtype}"
    right, yours = _as_numpy(expected), _as_numpy(got)
    wrong = np.argwhere(~_close(right, yours, tolerance))
    if len(wrong) == 0:
        return None
    at = tuple(wrong[0].tolist())
    where = f"{name}{list(at)}" if at else name
    return f"{where} should be {right[at]:.6g}, yours is {yours[at]:.6g}"


def _kind(value: object) -> str:
    if isinstance(value, Tensor):
        return "a tensor"
    return "a numpy array" if isinstance(value, np.ndarray) else brief(value)


def _as_numpy(value: Tensor | np.ndarray) -> np.ndarray:
    return value.detach().cpu().numpy() if isinstance(value, Tensor) else value


def _close(expected, got, tolerance: float) -> np.ndarray | np.bool_:
    return np.isclose(got, expected, rtol=tolerance, atol=tolerance, equal_nan=True)


def _equal(expected: object, got: object) -> bool:
    return type(expected) is type(got) and bool(expected == got)
