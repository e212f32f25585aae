# SPDX-License-Identifier: MIT
"""The meshes: real ones from $HEWER_DATA, generated ones from `hewer generate`."""
import os
import re
import subprocess
from pathlib import Path

from . import cache
from .judge import judge_topology

# In order of size: the first results come soon. graz_plato_uv is not among them: without its
# texture it is graz_plato_vcol to the last bit.
REAL = {
    "stanford_bunny": "stanford_bunny.ply",
    "laurana_rangemap_315": "laurana_rangemap_315.ply",
    "ct_luggage": "ct_luggage.ply",
    "graz_plato_vcol": "graz_plato_vcol.ply",
    "graz_kopfharmodios": "graz_kopfharmodios.glb",
    "stanford_dragon_res2": "stanford_dragon_res2.ply",
    "igea": "igea.ply",
    "freesurfer_lh": "freesurfer_lh.off",
    "motorbike_soup": "motorbike_soup.obj",
    "lidar_tin_fsite7": "lidar_tin_fsite7.ply",
    "ct_engine": "ct_engine.ply",
    "camitk_sinus_skin": "camitk_sinus_skin.ply",
    "stanford_dragon": "stanford_dragon.ply",
    "ct_bonsai": "ct_bonsai.ply",
    "petrochem_shihua": "petrochem_shihua.ply",
    "N41E002": "N41E002.hgt",
    "machangara_w": "machangara_w.ply",
}
GENERATED = {"scan3M": "3M", "scan12M": "12M"}
QUICK = ["stanford_bunny", "laurana_rangemap_315", "igea"]
NAMES = [*REAL, *GENERATED]


def count_triangles(path):
    """Faces as the header of a PLY says."""
    with open(path, "rb") as file:
        head = file.read(4096)
    found = re.search(rb"^element face (\d+)", head, re.MULTILINE)
    return int(found.group(1)) if found else 0


class Input:
    """A prepared mesh: `path`, `n_triangles`, `topology`, and `folder` for what is made of it."""

    def __init__(self, name, path):
        self.name = name
        self.path = path
        self.folder = path.parent
        self.n_triangles = count_triangles(path)
        self.topology = self._topology()

    def _topology(self):
        kept = self.folder / "input.topology.json"
        found = cache.load(kept)
        if not found:
            found = judge_topology(self.path)
            cache.save(kept, found)
        return found

    @property
    def is_closed(self):
        return self.topology["border_edges"] == 0 and self.topology["nonmanifold_edges"] == 0

    @property
    def has_border(self):
        return self.topology["border_edges"] > 0


def prepare(name):
    """The Input, or None if its file is not there."""
    path = cache.folder() / name / "input.ply"
    if not path.exists():
        part = path.with_name("input.part.ply")
        path.parent.mkdir(parents=True, exist_ok=True)
        if name in GENERATED:
            command = [cache.HEWER, "generate", part, "--triangles", GENERATED[name], "--force",
                       "--progress", "none"]
        else:
            source = Path(os.environ.get("HEWER_DATA", "")) / REAL[name]
            if not source.is_file():
                return None
            command = [cache.SCRIPTS / "prepare_mesh.py", source, part]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        part.rename(path)
    return Input(name, path)
