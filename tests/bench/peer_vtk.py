#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""VTK's decimators as a whole program, options as VTK sets them.

usage: tests/bench/peer_vtk.py quadric|pro IN.ply OUT.ply TARGET_TRIANGLES

quadric is vtkQuadricDecimation, pro is vtkDecimatePro (without which no topology would change, as
the quadrics allow). The interpreter is Debian's: only that one finds python3-vtk9.
"""
import sys

from vtkmodules.vtkFiltersCore import vtkDecimatePro, vtkQuadricDecimation
from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in ("quadric", "pro"):
        sys.exit(__doc__)
    method, source, result, target = sys.argv[1:]
    reader = vtkPLYReader()
    reader.SetFileName(source)
    reader.Update()
    n_triangles = reader.GetOutput().GetNumberOfPolys()
    decimate = vtkQuadricDecimation() if method == "quadric" else vtkDecimatePro()
    decimate.SetInputConnection(reader.GetOutputPort())
    decimate.SetTargetReduction(1 - int(target) / n_triangles)
    writer = vtkPLYWriter()
    writer.SetFileName(result)
    writer.SetFileTypeToBinary()
    writer.SetInputConnection(decimate.GetOutputPort())
    writer.Write()


main()
