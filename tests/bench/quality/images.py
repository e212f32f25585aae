# SPDX-License-Identifier: MIT
"""Differences of pictures from those of the original; see tests/bench/image_rms.cpp."""
from . import cache
from .judge import run_json


def judge_images(case):
    """Adds `image_rms` to the case's records that lack it, and keeps them."""
    folder = case.mesh.folder / case.percent
    records = {name: record for name, record in case.peers.items()}
    records.update({"hewer" if target == case.target else f"hewer-{target}": record
                    for target, record in case.hewer.items()})
    missing = [name for name, record in records.items()
               if record["status"] == "ok" and "image_rms" not in record]
    if not missing:
        return
    found = run_json([cache.TOOLS / "image_rms", case.mesh.path,
                      *(folder / f"{name}.ply" for name in missing)])
    for name, rms in zip(missing, found):
        records[name]["image_rms"] = rms
        cache.save(folder / f"{name}.json", records[name])
