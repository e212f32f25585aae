# SPDX-License-Identifier: MIT
"""Ratios of hewer to its peers, and the bars they are held against."""
import math
from dataclasses import dataclass, field

from .programs import COUNT_TOLERANCE

# A peer that cannot go below this many times the target is not compared at all.
MOST_COUNT_RATIO = 3.0
# hewer's time is held against the peer's on inputs of at least this many triangles.
TIMED_TRIANGLES = 3_000_000


@dataclass
class Bar:
    """The most that a ratio may be: on each case (infinite: no bar), and in the geometric mean."""

    title: str
    each: float
    mean: float
    ratios: dict = field(default_factory=dict)  # (mesh, ratio) -> value

    def geometric_mean(self):
        logs = [math.log(r) for r in self.ratios.values() if r > 0]
        return math.exp(sum(logs) / len(logs)) if logs else math.nan


def make_bars():
    return {
        "forward": Bar("forward RMS / best peer", 0.90, 0.80),
        "backward": Bar("backward RMS / best peer", 1.00, 0.92),
        "maximum": Bar("maximum / peer of least RMS", 1.20, 0.80),
        "time": Bar("seconds / peer of least RMS, 3 M triangles and above", 1 / 15, 1 / 15),
        "image": Bar("image RMS / best peer", math.inf, 1.00),
        "error": Bar("triangles for a maximum error / best peer", math.inf, 0.80),
    }


@dataclass
class Case:
    """One mesh at one ratio: records of all programs. `hewer` is keyed by target."""

    mesh: object
    percent: str
    target: int
    peers: dict
    hewer: dict

    @property
    def key(self):
        return self.mesh.name, self.percent

    def own(self):
        return self.hewer[self.target]

    def hewer_for(self, peer):
        """hewer's record at the peer's count; None where the two are not comparable."""
        record = self.peers[peer]
        if record["status"] != "ok":
            return None
        found = self.hewer.get(count_for(record, self.target))
        return found if found and found["status"] == "ok" else None


def count_for(record, target):
    """What hewer is asked for beside a peer: the target, or the peer's count where the peer stopped
    elsewhere; 0 where it is too far off."""
    count = record["triangles"]
    if abs(count - target) <= COUNT_TOLERANCE * target:
        return target
    return count if count <= MOST_COUNT_RATIO * target else 0


def larger(record, key):
    distances = record["distances"]
    return max(distances["forward"][key], distances["backward"][key])


def ratio(ours, theirs):
    if theirs > 0:
        return ours / theirs
    return 1.0 if ours == 0 else math.inf


def compare(case, bars):
    """Enters the ratios of a case; names of the best peers by direction, and by the larger."""
    pairs = {peer: (case.hewer_for(peer), case.peers[peer]) for peer in case.peers}
    pairs = {peer: pair for peer, pair in pairs.items() if pair[0]}
    best = {}
    if not pairs:
        return best
    for way in ("forward", "backward"):
        ratios = {peer: ratio(ours["distances"][way]["rms"], theirs["distances"][way]["rms"])
                  for peer, (ours, theirs) in pairs.items()}
        best[way] = max(ratios, key=ratios.get)
        bars[way].ratios[case.key] = ratios[best[way]]
    ratios = {peer: ratio(larger(ours, "rms"), larger(theirs, "rms"))
              for peer, (ours, theirs) in pairs.items()}
    best["rms"] = max(ratios, key=ratios.get)
    ours, theirs = pairs[best["rms"]]
    bars["maximum"].ratios[case.key] = ratio(larger(ours, "maximum"), larger(theirs, "maximum"))
    if case.mesh.n_triangles >= TIMED_TRIANGLES:
        # Peers have one thread: where they waited for a busy machine, their processor time tells.
        bars["time"].ratios[case.key] = (ours["seconds"] /
                                         min(theirs["seconds"], theirs["cpu_seconds"]))
    ratios = {peer: ratio(ours["image_rms"], theirs["image_rms"])
              for peer, (ours, theirs) in pairs.items() if "image_rms" in ours and "image_rms" in theirs}
    if ratios:
        best["image"] = max(ratios, key=ratios.get)
        bars["image"].ratios[case.key] = ratios[best["image"]]
    return best


def topology_faults(case):
    """What a closed input lost, as texts; [] where nothing is wrong, None where it was open."""
    if not case.mesh.is_closed or case.own()["status"] != "ok":
        return None
    before, after = case.mesh.topology, case.own()["topology"]
    faults = [f"{after[key]} {text}" for key, text in
              (("border_edges", "border edges"), ("nonmanifold_edges", "non-manifold edges"))
              if after[key]]
    # Parts that are too small for the budget may go, if the report says where they were.
    untold = case.own().get("parts", {}).get("untold")
    if untold is None or after["components"] > before["components"]:
        if after["components"] != before["components"]:
            faults.append(f"{after['components']} of {before['components']} components")
    elif untold:
        faults.append(f"{untold} of {before['components']} components neither kept nor listed")
    return faults


def border_faults(case):
    """The same for an input with borders: new loops, or a border that moved more than the surface
    (RMS, larger direction)."""
    record = case.own()
    if record["status"] != "ok" or "border" not in record:
        return None
    border = record["border"]
    faults = []
    if border["simplified"]["loops"] > border["original"]["loops"]:
        faults.append(f"{border['simplified']['loops']} loops, "
                      f"{border['original']['loops']} in the input")
    if not border["forward"]:
        faults.append("no border left")
    elif border_ratio(record) > 1:
        faults.append(f"border RMS {border_ratio(record):.2f} x the surface's")
    return faults


def border_ratio(record):
    """RMS of the border over that of the surface, larger directions; NaN without a border."""
    return ratio(border_rms(record), larger(record, "rms"))


def border_of_peers(case):
    """The least such ratio among the peers, and whose it is; None if none has a border."""
    ratios = {peer: border_ratio(record) for peer, record in case.peers.items()
              if record["status"] == "ok" and not math.isnan(border_rms(record))}
    best = min(ratios, key=ratios.get, default=None)
    return best and (ratios[best], best)


def border_rms(record):
    border = record.get("border")
    if not border or not border["forward"]:
        return math.nan
    return max(border["forward"]["rms"], border["backward"]["rms"])
