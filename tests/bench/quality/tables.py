# SPDX-License-Identifier: MIT
"""The markdown of docs/quality.md."""
import math
import os
import re

from .compare import (border_faults, border_of_peers, border_ratio, border_rms, compare, larger,
                      make_bars, topology_faults)
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
    """hewer first, then the peers; where one stopped elsewhere, hewer at that count beside it."""
    rows = []
    shown = [("hewer", case.own(), "")]
    for peer, record in case.peers.items():
        beside = case.hewer_for(peer)
        if beside is not None and beside is not case.own():
            shown.append((f"hewer, as many as {PEERS[peer][0]}", beside, ""))
        marks = [way for way in ("forward", "backward", "rms", "image") if best.get(way) == peer]
        shown.append((PEERS[peer][0], record, ", ".join(marks)))
    for name, record, marks in shown:
        if record["status"] != "ok":
            rows.append(row(case.mesh.name, case.percent, name, record["status"],
                            *[""] * 10))
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
            f"{record['image_rms']:.3f}" if "image_rms" in record else "-", marks))
    return rows


def summary(bars):
    lines = head("ratio", "geometric mean", "bar", "worst", "bar", "cases above the bar")
    for bar in bars.values():
        if not bar.ratios:
            continue
        worst = max(bar.ratios, key=bar.ratios.get)
        place = f" ({worst[0]}, {worst[1]} %)"
        lines.append(row(bar.title, verdict(bar.geometric_mean(), bar.mean),
                         f"<= {bar.mean:.3g}", *(
            (f"{bar.ratios[worst]:.3f}{place}", "-", "-") if math.isinf(bar.each) else
            (verdict(bar.ratios[worst], bar.each) + place, f"<= {bar.each:.3g}",
             f"{sum(r > bar.each for r in bar.ratios.values())} of {len(bar.ratios)}"))))
    return lines


def ratio_rows(cases, bars, best):
    lines = head("mesh", "%", "triangles", "forward RMS", "best peer", "backward RMS", "best peer",
                 "maximum", "time", "image RMS", "peer of least RMS", "closed stays closed",
                 "border", "border RMS / surface RMS", "least of the peers")
    for case in cases:
        own = case.own()
        if own["status"] != "ok":
            lines.append(row(case.mesh.name, case.percent, case.target,
                             f"**hewer {own['status']} FAIL**", *[""] * 11))
            continue
        names = {way: PEERS[peer][0] for way, peer in best[case.key].items()}
        cells = {key: verdict(bar.ratios.get(case.key, math.nan), bar.each)
                 for key, bar in bars.items() if math.isfinite(bar.each)}
        image = bars["image"].ratios.get(case.key)
        states = []
        for faults in (topology_faults(case), border_faults(case)):
            states.append("-" if faults is None else
                          f"**{', '.join(faults)} FAIL**" if faults else "PASS")
        lines.append(row(case.mesh.name, case.percent, own["triangles"], cells["forward"],
                         names.get("forward", "-"), cells["backward"], names.get("backward", "-"),
                         cells["maximum"], cells["time"], f"{image:.3f}" if image else "-",
                         names.get("rms", "-"), *states, *border_cells(case)))
    return lines


def border_cells(case):
    """hewer's ratio of the border to the surface, and the least of its peers: what is possible."""
    own = border_ratio(case.own())
    peers = border_of_peers(case)
    return ("-" if math.isnan(own) else f"{own:.2f}",
            f"{peers[0]:.2f} {PEERS[peers[1]][0]}" if peers else "-")


def left_out(cases):
    """Peers that no ratio speaks of, and why."""
    lines = []
    for case in cases:
        for peer, record in case.peers.items():
            if record["status"] != "ok":
                why = record["status"]
            elif case.hewer_for(peer) is None:
                why = f"ended at {record['triangles']} triangles instead of {case.target}"
            else:
                continue
            lines.append(f"- {case.mesh.name}, {case.percent} %: {PEERS[peer][0]} {why}")
    return ["", "Not compared:", "", *lines] if lines else []


def error_rows(error_cases, bars):
    """Enters the ratios of the counts, too."""
    lines = head("mesh", "E, % of the diagonal", "hewer, triangles", "its maximum / E",
                 "best peer, triangles", "ratio", "seconds of hewer")
    for case in error_cases:
        if case.hewer["status"] != "ok":
            lines.append(row(case.mesh.name, case.percent,
                             f"**hewer {case.hewer['status']} FAIL**", *[""] * 4))
            continue
        held = verdict(larger(case.hewer, "maximum") / case.limit, 1)
        peer = case.best_peer()
        count = "-"
        ratio = math.nan
        if peer:
            count = f"{PEERS[peer][0]}, {case.peers[peer]['triangles']}"
            ratio = case.hewer["triangles"] / case.peers[peer]["triangles"]
            bars["error"].ratios[case.mesh.name, case.percent] = ratio
        lines.append(row(case.mesh.name, case.percent, case.hewer["triangles"], held, count,
                         "-" if math.isnan(ratio) else f"{ratio:.3f}",
                         f"{case.hewer['seconds']:.2f}"))
    return lines


def count_failures(cases, error_cases, bars):
    failures = sum(case.hewer["status"] != "ok" or not case.holds() for case in error_cases)
    failures += sum(case.own()["status"] != "ok" for case in cases)
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


def tabulate(cases, error_cases):
    """Bars and ratios as a text, all figures as another, and the number of bars missed."""
    bars = make_bars()
    best = {case.key: compare(case, bars) if case.own()["status"] == "ok" else {}
            for case in cases}
    by_error = error_rows(error_cases, bars)
    lines = [f"Measured by `scripts/bench-quality` on {machine()}.", "", "### Bars", ""]
    lines += summary(bars)
    lines += ["", "### Ratios, hewer / best peer", "",
              "Below 1, hewer is closer to the original. The best peer of a column is the one that",
              "gives the largest ratio.", ""]
    lines += ratio_rows(cases, bars, best)
    lines += left_out(cases)
    if error_cases:
        lines += ["", "### Triangles for a maximum error", "",
                  "`hewer simplify --error E` beside the least count at which a peer's measured",
                  "maximum is at most E. Bar for the maximum: at most E.", "", *by_error]
    figures = ["", "### All figures", "",
               "Distances in % of the diagonal of the bounding box.", ""]
    figures += head("mesh", "%", "program", "triangles", "forward RMS", "backward RMS", "maximum",
                    "seconds", "processor seconds", "border / non-manifold edges", "components",
                    "border RMS", "image RMS", "best peer for")
    for case in cases:
        figures += case_rows(case, best[case.key])
    n_failed = count_failures(cases, error_cases, bars)
    return "\n".join(lines) + "\n", "\n".join(figures) + "\n", n_failed


def insert(document, begin, end, text):
    """`document` with what is between the two marker lines replaced."""
    before, rest = document.split(begin, 1)
    _, after = rest.split(end, 1)
    return f"{before}{begin}\n\n{text}\n{end}{after}"
