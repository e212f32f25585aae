#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Open3D's quadric decimation as a whole program, options as Open3D sets them.

usage: tests/bench/peer_open3d.py IN.ply OUT.ply TARGET_TRIANGLES

The interpreter is Debian's: only that one finds python3-open3d.
"""
import sys

import open3d


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    source, result, target = sys.argv[1:]
    mesh = open3d.io.read_triangle_mesh(source)
    mesh = mesh.simplify_quadric_decimation(int(target))
    if not open3d.io.write_triangle_mesh(result, mesh, write_vertex_normals=False):
        sys.exit(f"{result}: not written")


main()
