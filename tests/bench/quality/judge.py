# SPDX-License-Identifier: MIT
"""What is measured of a result. Distances come from `hewer measure` (which scripts/check-measure
compares with MeshLab's), topology and borders from programs that share nothing with hewer."""
import json
import subprocess

from . import cache


def run_json(command):
    return json.loads(subprocess.run([str(c) for c in command], check=True,
                                     stdout=subprocess.PIPE).stdout)


def judge_topology(path):
    """Counts with vertices at equal positions merged: not all peers keep seams closed by index."""
    return run_json([cache.TOOLS / "topology_check", path, "--edges-only"])["by_position"]


def judge_parts(mesh, simplified, report):
    """Whether the report of hewer tells of every component that is gone."""
    return run_json([cache.TOOLS / "part_check", mesh.path, simplified, report])


def judge_distances(original, simplified):
    report = simplified.with_suffix(".measure.json")
    report.unlink(missing_ok=True)
    subprocess.run([str(c) for c in (cache.HEWER, "measure", original, simplified, "--report",
                                     report, "--progress", "none")],
                   check=True, stdout=subprocess.DEVNULL)
    found = json.loads(report.read_text())
    report.unlink()
    keys = ("rms", "mean", "maximum", "worst")
    return {"diagonal": found["diagonal"],
            "forward": {key: found["forward"][key] for key in keys},
            "backward": {key: found["backward"][key] for key in keys}}


def judge(mesh, simplified):
    """Distances, topology, and, for an input with borders, how far these moved."""
    verdict = {"distances": judge_distances(mesh.path, simplified),
               "topology": judge_topology(simplified)}
    if mesh.has_border:
        verdict["border"] = run_json([cache.TOOLS / "border_check", mesh.path, simplified])
    return verdict
