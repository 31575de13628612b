"""The binary half of a glTF file: arrays, one after the other, and where each one lies.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import struct
from typing import BinaryIO

import numpy as np
import pygltflib as gltf

COMPONENTS = {
    np.dtype("f4"): gltf.FLOAT,
    np.dtype("u1"): gltf.UNSIGNED_BYTE,
    np.dtype("u4"): gltf.UNSIGNED_INT,
}


class Buffer:
    """Collects arrays (count, components); each gets a number by which a document names it.

    Every array is kept once, and written from there.
    """

    def __init__(self) -> None:
        self.blocks: list[bytes] = []
        self.length = 0
        self.views: list[gltf.BufferView] = []
        self.accessors: list[gltf.Accessor] = []

    def add(
        self, values: np.ndarray, kind: str, *, use: int | None = None, bounds: bool = False
    ) -> int:
        """Append an array of `kind` SCALAR, VEC3, VEC4 or MAT4; returns its number.

        Args:
            values: float32, uint8 or uint32.
            kind: what one row is.
            use: what a graphics card does with it: ARRAY_BUFFER or ELEMENT_ARRAY_BUFFER.
            bounds: whether to state the least and greatest values, as glTF wants for positions
                and times.
        """
        accessor = _accessor(values, kind, bounds)
        accessor.bufferView = self._view(values, use)
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def add_sparse(self, values: np.ndarray, kind: str) -> int:
        """The same, with bounds, for an array of mostly zeros: stores the other rows alone."""
        rows = np.flatnonzero(values.any(axis=1))
        rows = rows if len(rows) else np.array([0])
        accessor = _accessor(values, kind, bounds=True)
        places = self._view(rows.astype(np.uint32), None)
        accessor.sparse = gltf.Sparse(
            count=len(rows),
            indices=gltf.AccessorSparseIndices(bufferView=places, componentType=gltf.UNSIGNED_INT),
            values=gltf.AccessorSparseValues(bufferView=self._view(values[rows], None)),
        )
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def write(self, file: BinaryIO, document: gltf.GLTF2) -> None:
        """Write the whole GLB: a header, the document as JSON, then the arrays."""
        document.bufferViews, document.accessors = self.views, self.accessors
        document.buffers = [gltf.Buffer(byteLength=self.length)]
        text = document.gltf_to_json(separators=(",", ":"), indent=None).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + self.length
        file.write(struct.pack("<4s2I", b"glTF", 2, whole))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", self.length, b"BIN\0"))
        file.writelines(self.blocks)

    def _view(self, values: np.ndarray, use: int | None) -> int:
        content = np.ascontiguousarray(values).tobytes()
        view = gltf.BufferView(
            buffer=0, byteOffset=self.length, byteLength=len(content), target=use
        )
        self.views.append(view)
        self.blocks += [content, bytes(-len(content) % 4)]
        self.length += sum(map(len, self.blocks[-2:]))
        return len(self.views) - 1


def _accessor(values: np.ndarray, kind: str, bounds: bool) -> gltf.Accessor:
    accessor = gltf.Accessor(
        componentType=COMPONENTS[values.dtype], count=len(values), type=kind, byteOffset=None
    )
    if bounds:
        accessor.min = np.atleast_1d(values.min(axis=0)).tolist()
        accessor.max = np.atleast_1d(values.max(axis=0)).tolist()
    return accessor
