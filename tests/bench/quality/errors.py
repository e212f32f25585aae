# SPDX-License-Identifier: MIT
"""Triangles that a given error takes: `hewer --error E` against peers. These have no such option in
terms of a distance, so the least count whose measured maximum is at most E is searched for."""
import math
from dataclasses import dataclass

from . import cache
from .compare import larger
from .inputs import count_triangles
from .judge import judge_distances
from .programs import DEFAULT_CAP_SECONDS, PEERS, hewer_command, run_capped

PERCENTS = ["0.1", "0.02"]  # of the diagonal of the bounding box
# Largest inputs: a search takes ten runs of the peer, which for VTK are minutes each beyond that.
SEARCHED = {"meshopt": 20_000_000, "vtk": 1_000_000}
# The search ends when the count that holds is within this factor of one that does not.
PRECISION = 1.02
FEWEST_TRIANGLES = 16


@dataclass
class ErrorCase:
    """One mesh at one bound: `hewer`, and records of the peers, as they are kept."""

    mesh: object
    percent: str
    hewer: dict
    peers: dict

    @property
    def limit(self):
        return float(self.percent) / 100 * self.hewer["distances"]["diagonal"]

    def holds(self):
        return larger(self.hewer, "maximum") <= self.limit

    def best_peer(self):
        found = {name: r["triangles"] for name, r in self.peers.items() if r["status"] == "ok"}
        return min(found, key=found.get) if found else None


def search(mesh, name, percent, result):
    """The least count at which the peer's measured maximum is at most the error: a bisection of the
    logarithm, as if the maximum fell with the count. It nearly does."""
    low, high = FEWEST_TRIANGLES, mesh.n_triangles
    best = {"status": "ok", "triangles": mesh.n_triangles, "runs": 0}
    runs = 0
    while high > low * PRECISION:
        target = round(math.sqrt(low * high))
        result.unlink(missing_ok=True)
        runs += 1
        record = run_capped(PEERS[name][1](mesh.path, result, target), result.with_suffix(".log"),
                            DEFAULT_CAP_SECONDS)
        record["triangles"] = count_triangles(result) if result.exists() else 0
        if record["status"] != "ok" or record["triangles"] == 0:
            return {"status": record["status"], "runs": runs}
        record["distances"] = judge_distances(mesh.path, result)
        limit = float(percent) / 100 * record["distances"]["diagonal"]
        if larger(record, "maximum") <= limit:
            if record["triangles"] < best["triangles"]:
                best = record
            high = target
        else:
            low = target
    best["runs"] = runs
    return best


def run_error_case(mesh, percent, peers, program, is_cached, is_fresh, is_rerun):
    """None if `is_cached` asks for kept figures of peers and there are none."""
    folder = mesh.folder / f"error-{percent}"
    folder.mkdir(exist_ok=True)
    if is_cached and not any((folder / f"{name}.json").exists() for name in peers):
        return None
    kept = folder / "hewer.json"
    hewer = cache.load(kept)
    if is_rerun or not hewer or hewer.get("program") != program:
        result = folder / "hewer.ply"
        hewer = run_capped(hewer_command(mesh.path, result, "--error", percent + "%"),
                           result.with_suffix(".log"), DEFAULT_CAP_SECONDS)
        hewer["program"] = program
        if hewer["status"] == "ok":
            hewer["triangles"] = count_triangles(result)
            hewer["distances"] = judge_distances(mesh.path, result)
        cache.save(kept, hewer)
    found = {}
    for name in peers:
        if mesh.n_triangles > SEARCHED.get(name, 0):
            continue
        kept = folder / f"{name}.json"
        record = None if is_fresh else cache.load(kept)
        if not record and is_cached:
            continue
        if not record:
            record = search(mesh, name, percent, folder / f"{name}.ply")
            cache.save(kept, record)
        found[name] = record
    return ErrorCase(mesh, percent, hewer, found)
