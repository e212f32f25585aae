# SPDX-License-Identifier: MIT
"""The markdown of docs/quality.md."""
import math
import os
import re

from .compare import border_faults, border_rms, compare, larger, make_bars, topology_faults
from .programs import PEERS


def row(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |"


def head(*cells):
    return [row(*cells), "|" + "---|" * len(cells)]


def verdict(value, limit, text="{:.3f}"):
    if math.isnan(value):
        return "-"
    text = text.format(value)
    return f"{text} PASS" if value <= limit else f"**{text} FAIL**"


def percent(value, diagonal):
    return f"{100 * value / diagonal:.4f}"


def case_rows(case, best):
    """hewer first, then the peers; where a peer stopped elsewhere, hewer at that count beside it."""
    rows = []
    shown = [("hewer", case.own(), "")]
    for peer, record in case.peers.items():
        beside = case.hewer_for(peer)
        if beside is not None and beside is not case.own():
            shown.append((f"hewer, as many as {PEERS[peer][0]}", beside, ""))
        marks = [way for way in ("forward", "backward", "rms") if best.get(way) == peer]
        shown.append((PEERS[peer][0], record, ", ".join("RMS" if m == "rms" else m
                                                        for m in marks)))
    for name, record, marks in shown:
        if record["status"] != "ok":
            rows.append(row(case.mesh.name, case.percent, name, record["status"],
                            *[""] * 9))
            continue
        distances, topology = record["distances"], record["topology"]
        diagonal = distances["diagonal"]
        border = border_rms(record)
        rows.append(row(
            case.mesh.name, case.percent, name, record["triangles"],
            percent(distances["forward"]["rms"], diagonal),
            percent(distances["backward"]["rms"], diagonal),
            percent(larger(record, "maximum"), diagonal),
            f"{record['seconds']:.2f}", f"{record['cpu_seconds']:.2f}",
            f"{topology['border_edges']} / {topology['nonmanifold_edges']}",
            topology["components"], "-" if math.isnan(border) else percent(border, diagonal),
            marks))
    return rows


def summary(bars):
    lines = head("ratio", "geometric mean", "bar", "worst", "bar", "cases above the bar")
    for bar in bars.values():
        if not bar.ratios:
            lines.append(row(bar.title, "-", f"<= {bar.mean:.3g}", "-", f"<= {bar.each:.3g}", "-"))
            continue
        worst = max(bar.ratios, key=bar.ratios.get)
        above = sum(value > bar.each for value in bar.ratios.values())
        lines.append(row(bar.title, verdict(bar.geometric_mean(), bar.mean),
                         f"<= {bar.mean:.3g}",
                         verdict(bar.ratios[worst], bar.each) + f" ({worst[0]}, {worst[1]} %)",
                         f"<= {bar.each:.3g}", f"{above} of {len(bar.ratios)}"))
    return lines


def ratio_rows(cases, bars, best):
    lines = head("mesh", "%", "triangles", "forward RMS", "best peer", "backward RMS", "best peer",
                 "maximum", "time", "peer of least RMS", "closed stays closed", "border")
    for case in cases:
        own = case.own()
        if own["status"] != "ok":
            lines.append(row(case.mesh.name, case.percent, case.target,
                             f"**hewer {own['status']} FAIL**", *[""] * 8))
            continue
        names = {way: PEERS[peer][0] for way, peer in best[case.key].items()}
        cells = {key: verdict(bar.ratios.get(case.key, math.nan), bar.each)
                 for key, bar in bars.items()}
        states = []
        for faults in (topology_faults(case), border_faults(case)):
            states.append("-" if faults is None else
                          f"**{', '.join(faults)} FAIL**" if faults else "PASS")
        lines.append(row(case.mesh.name, case.percent, own["triangles"], cells["forward"],
                         names.get("forward", "-"), cells["backward"], names.get("backward", "-"),
                         cells["maximum"], cells["time"], names.get("rms", "-"), *states))
    return lines


def count_failures(cases, bars):
    failures = sum(case.own()["status"] != "ok" for case in cases)
    for bar in bars.values():
        failures += sum(value > bar.each for value in bar.ratios.values())
        failures += bool(bar.ratios) and bar.geometric_mean() > bar.mean
    for case in cases:
        failures += bool(topology_faults(case)) + bool(border_faults(case))
    return failures


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = re.search(r"^model name\s*: (.*)$", file.read(), re.MULTILINE)
    return f"{model.group(1) if model else 'unknown processor'}, {os.cpu_count()} processors"


def tabulate(cases):
    """All tables as a text, and the number of bars missed."""
    bars = make_bars()
    best = {case.key: compare(case, bars) if case.own()["status"] == "ok" else {}
            for case in cases}
    lines = [f"Measured by `scripts/bench-quality` on {machine()}.", "", "### Bars", ""]
    lines += summary(bars)
    lines += ["", "### Ratios, hewer / best peer", "",
              "Below 1, hewer is closer to the original. The best peer of a column is the one that",
              "gives the largest ratio.", ""]
    lines += ratio_rows(cases, bars, best)
    lines += ["", "### All figures", "",
              "Distances in % of the diagonal of the bounding box.", ""]
    lines += head("mesh", "%", "program", "triangles", "forward RMS", "backward RMS", "maximum",
                  "seconds", "processor seconds", "border / non-manifold edges", "components",
                  "border RMS", "best peer for")
    for case in cases:
        lines += case_rows(case, best[case.key])
    return "\n".join(lines) + "\n", count_failures(cases, bars)


def insert(document, begin, end, text):
    """`document` with what is between the two marker lines replaced."""
    before, rest = document.split(begin, 1)
    _, after = rest.split(end, 1)
    return f"{before}{begin}\n\n{text}\n{end}{after}"
