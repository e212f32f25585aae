# SPDX-License-Identifier: MIT
"""Where meshes and figures of the benchmark stay between runs.

One folder a mesh, with its prepared input; in it one folder a ratio, with PROGRAM.ply and
PROGRAM.json. Peers are slow and do not change: their figures are used again until --fresh. Those of
hewer are used again as long as its program has the same bytes.
"""
import hashlib
import json
import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
HEWER = ROOT / "build" / "release" / "hewer"
TOOLS = ROOT / "build" / "release" / "tests" / "bench"
SCRIPTS = ROOT / "tests" / "bench"


def folder():
    return Path(os.environ.get("HEWER_BENCH_CACHE", ROOT / "build" / "bench-quality"))


def fingerprint(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


def load(path):
    """The record, or None if there is none."""
    return json.loads(path.read_text()) if path.exists() else None


def save(path, record):
    part = path.with_suffix(".part")
    part.write_text(json.dumps(record, indent=1) + "\n")
    part.rename(path)
