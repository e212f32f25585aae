#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tests of scripts/bench-quality: how counts are matched and bars are judged, and its judges on
meshes whose answers are known.

usage: tests/bench/quality_test.py FOLDER_OF_THE_JUDGES
"""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True

from quality import compare, tables  # noqa: E402

TOOLS = Path(sys.argv.pop())


def record(triangles, forward, backward, maximum=1.0, seconds=1.0):
    return {"status": "ok", "triangles": triangles, "seconds": seconds, "cpu_seconds": seconds,
            "distances": {"diagonal": 100.0, "forward": {"rms": forward, "maximum": maximum},
                          "backward": {"rms": backward, "maximum": maximum / 2}},
            "topology": {"border_edges": 0, "nonmanifold_edges": 0, "components": 1}}


def mesh(n_triangles=10_000, is_closed=True, components=1):
    return SimpleNamespace(name="mesh", n_triangles=n_triangles, is_closed=is_closed,
                           topology={"components": components})


def case(peers, hewer, **of_mesh):
    return compare.Case(mesh(**of_mesh), "5", 1000, peers, hewer)


class Comparison(unittest.TestCase):
    def test_peer_at_the_target_meets_the_run_at_the_target(self):
        self.assertEqual(compare.count_for(record(997, 1, 1), 1000), 1000)

    def test_peer_that_stopped_elsewhere_meets_a_run_at_its_count(self):
        self.assertEqual(compare.count_for(record(1200, 1, 1), 1000), 1200)

    def test_peer_far_above_the_target_is_left_out(self):
        self.assertEqual(compare.count_for(record(4000, 1, 1), 1000), 0)

    def test_best_peer_is_the_one_of_the_largest_ratio_in_each_direction(self):
        bars = compare.make_bars()
        best = compare.compare(case({"a": record(1000, 2.0, 5.0), "b": record(1000, 4.0, 1.0)},
                                    {1000: record(1000, 1.0, 1.0)}), bars)
        self.assertEqual((best["forward"], best["backward"]), ("a", "b"))
        self.assertEqual(bars["forward"].ratios["mesh", "5"], 0.5)
        self.assertEqual(bars["backward"].ratios["mesh", "5"], 1.0)

    def test_peer_at_more_triangles_is_not_compared_with_the_run_at_the_target(self):
        bars = compare.make_bars()
        compare.compare(case({"a": record(1500, 1.0, 1.0)},
                             {1000: record(1000, 2.0, 2.0), 1500: record(1500, 0.5, 0.5)}), bars)
        self.assertEqual(bars["forward"].ratios["mesh", "5"], 0.5)

    def test_time_is_judged_on_large_inputs_only(self):
        for n_triangles, is_timed in ((2_999_999, False), (3_000_000, True)):
            bars = compare.make_bars()
            compare.compare(case({"a": record(1000, 1, 1, seconds=30)},
                                 {1000: record(1000, 1, 1, seconds=1)},
                                 n_triangles=n_triangles), bars)
            self.assertEqual(bool(bars["time"].ratios), is_timed)

    def test_failed_peer_is_not_compared(self):
        bars = compare.make_bars()
        self.assertEqual(compare.compare(case({"a": {"status": "failed with 1", "triangles": 0}},
                                              {1000: record(1000, 1, 1)}), bars), {})

    def test_lost_component_of_a_closed_input_is_a_fault(self):
        self.assertEqual(compare.topology_faults(case({}, {1000: record(1000, 1, 1)})), [])
        faults = compare.topology_faults(case({}, {1000: record(1000, 1, 1)}, components=2))
        self.assertEqual(faults, ["1 of 2 components"])

    def test_component_that_is_gone_and_listed_is_none(self):
        for untold, faults in ((0, []), (1, ["1 of 5 components neither kept nor listed"])):
            run = dict(record(1000, 1, 1), parts={"untold": untold})
            self.assertEqual(
                compare.topology_faults(case({}, {1000: run}, components=5)), faults)

    def test_component_more_is_a_fault_whatever_is_listed(self):
        run = dict(record(1000, 1, 1), parts={"untold": 0})
        run["topology"] = dict(run["topology"], components=2)
        self.assertEqual(compare.topology_faults(case({}, {1000: run})), ["2 of 1 components"])

    def test_mean_above_its_bar_fails_though_each_case_passes(self):
        bars = {"forward": compare.Bar("forward", 0.90, 0.80, {("a", "5"): 0.85})}
        self.assertEqual(tables.count_failures([], [], bars), 1)
        self.assertIn("0.850 FAIL", "\n".join(tables.summary(bars)))

    def test_geometric_mean(self):
        bar = compare.Bar("", 1, 1, {1: 0.5, 2: 2.0})
        self.assertAlmostEqual(bar.geometric_mean(), 1.0)

    def test_text_replaces_what_is_between_the_markers(self):
        self.assertEqual(tables.insert("a<b>old<e>z", "<b>", "<e>", "new"), "a<b>\n\nnew\n<e>z")


def grid(path, side, has_hole=False, height=0.0):
    """A square of 2 side^2 triangles, its middle one cut out or not, as ASCII PLY."""
    points = [f"{x / side} {y / side} {height}" for y in range(side + 1) for x in range(side + 1)]
    faces = []
    for y in range(side):
        for x in range(side):
            if has_hole and x == y == side // 2:
                continue
            a, b = y * (side + 1) + x, (y + 1) * (side + 1) + x
            faces += [f"3 {a} {a + 1} {b + 1}", f"3 {a} {b + 1} {b}"]
    path.write_text("ply\nformat ascii 1.0\n"
                    f"element vertex {len(points)}\nproperty float x\nproperty float y\n"
                    f"property float z\nelement face {len(faces)}\n"
                    "property list uchar int vertex_indices\nend_header\n" +
                    "\n".join(points + faces) + "\n")
    return path


def triangles(path, corners):
    """Triangles that share no vertex, as ASCII PLY."""
    path.write_text("ply\nformat ascii 1.0\n"
                    f"element vertex {3 * len(corners)}\nproperty float x\n"
                    f"property float y\nproperty float z\nelement face {len(corners)}\n"
                    "property list uchar int vertex_indices\nend_header\n" +
                    "".join("%g %g %g\n" % p for face in corners for p in face) +
                    "".join(f"3 {i} {i + 1} {i + 2}\n" for i in range(0, 3 * len(corners), 3)))
    return path


class Judges(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def judge(self, program, *paths):
        return json.loads(subprocess.run([TOOLS / program, *paths], check=True,
                                         stdout=subprocess.PIPE).stdout)

    def test_border_of_a_coarser_square_lies_on_that_of_the_fine_one(self):
        found = self.judge("border_check", grid(self.folder / "fine.ply", 16),
                           grid(self.folder / "coarse.ply", 4))
        self.assertEqual((found["original"]["loops"], found["simplified"]["loops"]), (1, 1))
        self.assertAlmostEqual(found["original"]["length"], 4.0, places=5)
        self.assertLess(found["forward"]["maximum"], 1e-6)

    def test_border_that_moved_is_measured(self):
        found = self.judge("border_check", grid(self.folder / "a.ply", 8),
                           grid(self.folder / "b.ply", 8, height=0.25))
        for way in ("forward", "backward"):
            self.assertAlmostEqual(found[way]["rms"], 0.25, places=6)
            self.assertAlmostEqual(found[way]["maximum"], 0.25, places=6)

    def test_new_hole_is_a_loop_more_and_far_from_the_old_border(self):
        found = self.judge("border_check", grid(self.folder / "a.ply", 9),
                           grid(self.folder / "b.ply", 9, has_hole=True))
        self.assertEqual((found["original"]["loops"], found["simplified"]["loops"]), (1, 2))
        self.assertLess(found["forward"]["maximum"], 1e-6)
        self.assertAlmostEqual(found["backward"]["maximum"], 4 / 9, places=5)

    def test_part_that_is_gone_is_told_of_or_not(self):
        both = triangles(self.folder / "both.ply",
                         [((0, 0, height), (1, 0, height), (0, 1, height)) for height in (0, 5)])
        for center, size, told in (((0, 0, 5), 0.1, 1), ((0, 0, 0), 0.1, 0), ((0, 0, 2), 7, 1)):
            report = self.folder / "report.json"
            report.write_text(json.dumps(
                {"lods": [{"lost": {"list": [{"center": center, "size": size}]}}]}))
            found = self.judge("part_check", both, grid(self.folder / "one.ply", 1), report)
            self.assertEqual((found["parts"], found["missing"], found["told"], found["untold"]),
                             (2, 1, told, 1 - told))

    def test_small_part_beside_a_large_one_is_there_if_a_spare_piece_is_where_it_was(self):
        large, small = ((0, 0, 0), (9, 0, 0), (0, 9, 0)), ((0, 0, 1), (1, 0, 1), (0, 1, 1))
        both = triangles(self.folder / "both.ply", [large, small])
        report = self.folder / "report.json"
        report.write_text(json.dumps({"lods": [{"lost": {"list": []}}]}))
        # Two corners of the piece are nearest to a corner of the large triangle.
        for pieces, untold in (([large, ((0, 0, 0.4), (0.1, 0, 0.4), (0, 0, 0.8))], 0),
                               ([((0, 0, 0.4), (0.1, 0, 0.4), (0, 0, 0.8))], 1),
                               ([large, ((0, 0, 0.4), (0.1, 0, -4), (0, 0, 0.8))], 1),
                               ([large, ((0, 0, 0.4), (0.1, 0, 0.4), (0, 0, 0.3))], 1)):
            found = self.judge("part_check", both, triangles(self.folder / "after.ply", pieces),
                               report)
            self.assertEqual((found["parts"], found["untold"]), (2, untold))

    def test_pictures_of_the_same_surface_are_equal_and_of_another_are_not(self):
        fine = grid(self.folder / "fine.ply", 16)
        same, other = self.judge("image_rms", fine, grid(self.folder / "coarse.ply", 4),
                                 grid(self.folder / "hole.ply", 3, has_hole=True))
        self.assertLess(same, 0.5)
        self.assertGreater(other, 2)
        self.assertFalse(math.isnan(other))


if __name__ == "__main__":
    unittest.main()
