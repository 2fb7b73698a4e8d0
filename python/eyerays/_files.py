"""Files that a scene in code becomes: its tables as TOML, its meshes as glTF."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FLOAT, UNSIGNED = 5126, 5125


def toml(tables: Mapping[str, Any]) -> str:
    """A document: single values first, then tables, and lists of tables."""
    tables = {key: value for key, value in tables.items() if value is not None}
    lines = [f"{_key(key)} = {_value(key, value)}" for key, value in tables.items() if not _is_section(value)]
    for key, value in tables.items():
        if _is_section(value):
            for table in [value] if isinstance(value, Mapping) else value:
                lines.append(f"[{_key(key)}]" if isinstance(value, Mapping) else f"[[{_key(key)}]]")
                lines += [f"{_key(name)} = {_value(name, of)}" for name, of in table.items() if of is not None]
    return "\n".join(lines) + "\n"


def _is_section(value: Any) -> bool:
    return isinstance(value, Mapping) or (isinstance(value, list) and bool(value) and all(isinstance(of, Mapping) for of in value))


def _key(key: str) -> str:
    return json.dumps(str(key), ensure_ascii=False)


def _value(key: str, value: Any) -> str:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(name)} = {_value(name, of)}" for name, of in value.items() if of is not None) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(key, of) for of in value) + "]"
    if hasattr(value, "__fspath__"):
        return _value(key, value.__fspath__())
    raise TypeError(f"{key} is a {type(value).__name__}, which no scene says")


def glb(
    name: str,
    vertices: NDArray,
    faces: NDArray,
    normals: NDArray | None = None,
    uv: NDArray | None = None,
    transforms: NDArray | None = None,
) -> bytes:
    """A binary glTF file of one mesh, where it is or where matrices put it; `uv` has its second coordinate up."""
    parts: list[bytes] = []
    views: list[dict] = []
    accessors: list[dict] = []

    def put(array: NDArray, kind: str, component: int, **more: Any) -> int:
        views.append({"buffer": 0, "byteOffset": sum(map(len, parts)), "byteLength": array.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind, **more})
        parts.append(array.tobytes())
        return len(accessors) - 1

    places = vertices.astype("<f4")
    bounds = {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
    attributes = {"POSITION": put(places, "VEC3", FLOAT, **bounds)}
    if normals is not None:
        attributes["NORMAL"] = put(normals.astype("<f4"), "VEC3", FLOAT)
    if uv is not None:
        attributes["TEXCOORD_0"] = put((uv * [1, -1] + [0, 1]).astype("<f4"), "VEC2", FLOAT)
    indices = put(faces.astype("<u4").reshape(-1), "SCALAR", UNSIGNED)
    nodes: list[dict] = [{"name": name, "mesh": 0}]
    if transforms is not None:
        nodes = [{"name": name, "mesh": 0, "matrix": matrix.T.reshape(-1).tolist()} for matrix in transforms]
    document = {
        "asset": {"version": "2.0", "generator": "eyerays"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": [{"name": name, "primitives": [{"attributes": attributes, "indices": indices}]}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": sum(map(len, parts))}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    length = sum(map(len, parts))
    head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + length)
    return b"".join([head, struct.pack("<I4s", len(text), b"JSON"), text, struct.pack("<I4s", length, b"BIN\0"), *parts])
