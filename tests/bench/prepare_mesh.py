#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the file that hewer and all its peers read: the same points and triangles for each.

usage: tests/bench/prepare_mesh.py IN.{ply,off,obj,glb,hgt} OUT.ply

Binary little-endian PLY of float positions and triangles. Vertices at equal positions are one,
unused ones are left out, so are triangles with two corners in one vertex: peers that join nothing
would see cracks at texture seams, and the comparison would be of readers. Colours and texture
coordinates are left out: half of the peers ignore them.

An .hgt file is a square grid of big-endian 16-bit heights, -32768 for none, 3 arc seconds apart:
two triangles for each four neighbours that have a height, metres on the ground.
"""
import json
import math
import re
import struct
import sys
from pathlib import Path

import numpy as np

PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2",
             "int16": "i2", "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4",
             "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4", "double": "f8",
             "float64": "f8"}
HGT_VOID = -32768
ARC_SECOND_METRES = 30.87


def parse_ply_header(data):
    """Format, [(element, count, [(name, type, count type or None)])], offset of the body."""
    end = data.index(b"end_header")
    end = data.index(b"\n", end) + 1
    elements, form = [], None
    for line in data[:end].decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].append((words[4], PLY_TYPES[words[3]], PLY_TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], PLY_TYPES[words[1]], None))
    return form, elements, end


def triangles_of_strip(strip):
    """Triangles of the strips in a list, parted by -1; every second one is turned."""
    triangles = []
    for run in np.split(strip, np.flatnonzero(strip < 0)):
        run = run[run >= 0]
        if len(run) < 3:
            continue
        corners = np.stack([run[:-2], run[1:-1], run[2:]], axis=1)
        corners[1::2] = corners[1::2, [1, 0, 2]]
        triangles.append(corners)
    return np.concatenate(triangles)


def read_ply(path):
    data = path.read_bytes()
    form, elements, at = parse_ply_header(data)
    if form == "binary_big_endian":
        sys.exit(f"{path}: big-endian")
    numbers = np.array(data[at:].split(), dtype="f8") if form == "ascii" else None
    column, points, triangles = 0, None, None
    for name, count, properties in elements:
        has_list = any(kind for _, _, kind in properties)
        if name == "tristrips":
            (length,) = struct.unpack_from("<i", data, at)
            strip = np.frombuffer(data, "<i4", length, at + 4)
            triangles = triangles_of_strip(strip)
        elif numbers is not None:
            width = sum(4 if kind else 1 for _, _, kind in properties)
            rows = numbers[column:column + count * width].reshape(count, width)
            column += count * width
            if name == "vertex":
                names = [p[0] for p in properties]
                points = rows[:, [names.index(axis) for axis in "xyz"]]
            elif name == "face":
                if (rows[:, 0] != 3).any():
                    sys.exit(f"{path}: not all faces are triangles")
                triangles = rows[:, 1:4].astype("i8")
        else:
            # Lists are taken to have three entries, which is checked.
            kinds = []
            for key, kind, count_kind in properties:
                kinds += ([(key + "_count", "<" + count_kind), (key, "<" + kind, 3)]
                          if count_kind else [(key, "<" + kind)])
            rows = np.frombuffer(data, np.dtype(kinds), count, at)
            at += rows.nbytes
            if name == "vertex":
                points = np.stack([rows[axis] for axis in "xyz"], axis=1)
            elif has_list:
                key = next(p[0] for p in properties if p[2])
                if (rows[key + "_count"] != 3).any():
                    sys.exit(f"{path}: not all faces are triangles")
                triangles = rows[key].astype("i8")
    return points, triangles


def read_off(path):
    words = path.read_bytes().split()
    n_vertices, n_faces = int(words[1]), int(words[2])
    first_face = 4 + 3 * n_vertices
    points = np.array(words[4:first_face], dtype="f8").reshape(-1, 3)
    faces = np.array(words[first_face:first_face + 4 * n_faces], dtype="i8").reshape(-1, 4)
    return points, faces[:, 1:]


def read_obj(path):
    points, triangles = [], []
    for line in path.read_text(encoding="latin-1").splitlines():
        if line.startswith("v "):
            points.append([float(x) for x in line.split()[1:4]])
        elif line.startswith("f "):
            ids = [int(corner.split("/")[0]) - 1 for corner in line.split()[1:]]
            triangles += [[ids[0], ids[i - 1], ids[i]] for i in range(2, len(ids))]
    return np.array(points), np.array(triangles)


def read_glb(path):
    """All primitives of all meshes, as they lie: nodes are not transformed."""
    data = path.read_bytes()
    (json_bytes,) = struct.unpack_from("<I", data, 12)
    scene = json.loads(data[20:20 + json_bytes])
    body = data[28 + json_bytes:]

    def accessor(index):
        found = scene["accessors"][index]
        view = scene["bufferViews"][found["bufferView"]]
        kind = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[found["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3}[found["type"]]
        offset = view.get("byteOffset", 0) + found.get("byteOffset", 0)
        return np.frombuffer(body, kind, found["count"] * width, offset).reshape(-1, width)

    points, triangles, n_points = [], [], 0
    for mesh in scene["meshes"]:
        for primitive in mesh["primitives"]:
            points.append(accessor(primitive["attributes"]["POSITION"]))
            triangles.append(accessor(primitive["indices"]).reshape(-1, 3).astype("i8") + n_points)
            n_points += len(points[-1])
    return np.concatenate(points), np.concatenate(triangles)


def read_hgt(path):
    heights = np.frombuffer(path.read_bytes(), ">i2").astype("f8")
    side = math.isqrt(len(heights))
    heights = heights.reshape(side, side)[::-1]  # the file starts in the north
    latitude = int(re.match(r"[NS](\d+)", path.name).group(1)) + 0.5
    step = 3600 / (side - 1) * ARC_SECOND_METRES
    x, y = np.meshgrid(np.arange(side) * step * math.cos(math.radians(latitude)),
                       np.arange(side) * step)
    points = np.stack([x, y, heights], axis=2).reshape(-1, 3)
    ids = np.arange(side * side).reshape(side, side)
    a, b, c, d = ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1]
    triangles = np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3)
    is_known = (heights != HGT_VOID).reshape(-1)
    return points, triangles[is_known[triangles].all(axis=1)]


def weld(points, triangles):
    points = np.ascontiguousarray(points, dtype="<f4") + np.float32(0)  # -0 becomes 0
    _, first, where = np.unique(points.view("V12").reshape(-1), return_index=True,
                                return_inverse=True)
    triangles = first[where.reshape(-1)[triangles]]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    # In the order of the file: streams profit from that as they would on the original.
    used, ids = np.unique(triangles, return_inverse=True)
    return points[used], ids.reshape(-1, 3).astype("<i4")


def write_ply(path, points, triangles):
    records = np.empty(len(triangles), dtype=[("n", "u1"), ("ids", "<i4", 3)])
    records["n"] = 3
    records["ids"] = triangles
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\n"
                   b"element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
                   b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
                   % (len(points), len(triangles)))
        file.write(points.tobytes())
        file.write(records.tobytes())


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source = Path(sys.argv[1])
    read = {".ply": read_ply, ".off": read_off, ".obj": read_obj, ".glb": read_glb,
            ".hgt": read_hgt}[source.suffix]
    write_ply(sys.argv[2], *weld(*read(source)))


main()
