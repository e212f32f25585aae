# SPDX-License-Identifier: MIT
"""hewer and its peers as whole programs: read the input, simplify, write the result."""
import os
import resource
import shutil
import signal
import subprocess
import time

from . import cache
from .inputs import count_triangles
from .judge import judge, judge_parts

# Of processor time: a busy machine must not end a run that a quiet one would finish. A process that
# waits instead of working is ended after a multiple of that.
DEFAULT_CAP_SECONDS = 600
WALL_CAPS = 10
CAP_BYTES = 16 << 30
# A peer that ends at another count than it was asked for is asked again once if it stopped short,
# and taken to be at the count when it is this close.
COUNT_TOLERANCE = 0.005

MESHLAB_SCRIPT = """<!DOCTYPE FilterScript>
<FilterScript>
 <filter name="Simplification: Quadric Edge Collapse Decimation">
  <Param type="RichInt" name="TargetFaceNum" value="{target}"/>
  <Param type="RichFloat" name="TargetPerc" value="0"/>
  <Param type="RichFloat" name="QualityThr" value="0.3"/>
  <Param type="RichBool" name="PreserveBoundary" value="false"/>
  <Param type="RichFloat" name="BoundaryWeight" value="1"/>
  <Param type="RichBool" name="PreserveNormal" value="false"/>
  <Param type="RichBool" name="PreserveTopology" value="false"/>
  <Param type="RichBool" name="OptimalPlacement" value="true"/>
  <Param type="RichBool" name="PlanarQuadric" value="false"/>
  <Param type="RichFloat" name="PlanarWeight" value="0.001"/>
  <Param type="RichBool" name="QualityWeight" value="false"/>
  <Param type="RichBool" name="AutoClean" value="true"/>
  <Param type="RichBool" name="Selected" value="false"/>
 </filter>
</FilterScript>
"""


def hewer_command(source, result, *target):
    """`target` is an option and its value."""
    return [cache.HEWER, "simplify", source, "-o", result, *target, "--report",
            result.with_suffix(".report.json"), "--progress", "none", "--force"]


def meshlab_command(source, result, target):
    script = result.with_suffix(".mlx")
    script.write_text(MESHLAB_SCRIPT.format(target=target))
    return ["meshlabserver", "-i", source, "-o", result, "-s", script]


# Name: what the tables call it, and its command line.
PEERS = {
    "meshopt": ("meshoptimizer", lambda source, result, target: [
        cache.TOOLS / "peer_meshopt", "simplify", source, result, target]),
    "vtk": ("VTK quadric", lambda source, result, target: [
        cache.SCRIPTS / "peer_vtk.py", "quadric", source, result, target]),
    "vcg": ("MeshLab", meshlab_command),
    "openmesh": ("OpenMesh", lambda source, result, target: [
        cache.TOOLS / "peer_openmesh", source, result, target]),
    "open3d": ("Open3D", lambda source, result, target: [
        cache.SCRIPTS / "peer_open3d.py", source, result, target]),
}


class Display:
    """A virtual display for MeshLab, started once: xvfb-run would wait for one at every start, and
    the time of the peer would be that of the waiting."""

    def __init__(self):
        self.server = None

    def __enter__(self):
        if not os.environ.get("DISPLAY") and shutil.which("Xvfb"):
            read_end, write_end = os.pipe()
            self.server = subprocess.Popen(
                ["Xvfb", "-displayfd", str(write_end), "-screen", "0", "640x480x24"],
                pass_fds=[write_end], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            os.close(write_end)
            with os.fdopen(read_end) as number:
                os.environ["DISPLAY"] = ":" + number.readline().strip()
        return self

    def __exit__(self, *_):
        if self.server:
            self.server.terminate()
            self.server.wait()
            del os.environ["DISPLAY"]


def run_capped(command, log, cap_seconds):
    """Wall and processor seconds and peak memory of a process, or why it did not finish."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (CAP_BYTES, CAP_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (int(cap_seconds), int(cap_seconds) + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    with open(log, "wb") as output:
        child = subprocess.Popen([str(c) for c in command], stdout=output,
                                 stderr=subprocess.STDOUT, preexec_fn=limit,
                                 env=dict(os.environ, LC_ALL="C"))
        # wait4 tells the peak of this child alone; it has no time limit of its own.
        try:
            pid = 0
            while not pid:
                if time.monotonic() - start > WALL_CAPS * cap_seconds:
                    child.kill()
                time.sleep(0.002)
                pid, status, usage = os.wait4(child.pid, os.WNOHANG)
        except BaseException:  # interrupted: nobody else would end it
            child.kill()
            raise
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return {"status": f"did not finish in {cap_seconds:g} s"}
    if child.returncode != 0:
        return {"status": f"failed with {child.returncode}"}
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"status": "ok", "seconds": time.monotonic() - start,
            "cpu_seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
            "peak_mib": usage.ru_maxrss / 1024, "load": os.getloadavg()[0]}


def simplify(command_of, mesh, target, result, cap_seconds):
    """One record: how the run went, and all that is measured of its result."""
    def attempt(asked):
        record = run_capped(command_of(mesh.path, result, asked), result.with_suffix(".log"),
                            cap_seconds)
        record.update(asked=asked, triangles=0)
        if record["status"] == "ok":
            record["triangles"] = count_triangles(result) if result.exists() else 0
            if record["triangles"] == 0:
                record["status"] = "wrote no triangles"
        return record

    result.unlink(missing_ok=True)
    record = attempt(target)
    if record["status"] == "ok" and record["triangles"] < (1 - COUNT_TOLERANCE) * target:
        again = attempt(min(mesh.n_triangles, target * target // record["triangles"]))
        record = again if again["status"] == "ok" else attempt(target)
    if record["status"] == "ok":
        record.update(judge(mesh, result))
    return record


def run_peer(name, mesh, folder, target, cap_seconds, is_fresh):
    kept = folder / f"{name}.json"
    record = None if is_fresh else cache.load(kept)
    if not record:
        record = simplify(PEERS[name][1], mesh, target, folder / f"{name}.ply", cap_seconds)
        cache.save(kept, record)
    return record


def rejudge_peer(name, mesh, folder):
    """The same result, measured again: for a changed `hewer measure`."""
    kept = folder / f"{name}.json"
    record = cache.load(kept)
    if record and record["status"] == "ok":
        record.update(judge(mesh, folder / f"{name}.ply"))
        cache.save(kept, record)


def run_hewer(mesh, folder, target, program, is_rerun):
    """`program` is the fingerprint of hewer's executable."""
    stem = "hewer" if target == folder_target(mesh, folder) else f"hewer-{target}"
    kept = folder / f"{stem}.json"
    record = cache.load(kept)
    if is_rerun or not record or record.get("program") != program:
        result = folder / f"{stem}.ply"
        record = simplify(
            lambda source, to, count: hewer_command(source, to, "--triangles", count),
            mesh, target, result, DEFAULT_CAP_SECONDS)
        if record["status"] == "ok" and mesh.is_closed:
            record["parts"] = judge_parts(mesh, result, result.with_suffix(".report.json"))
        record["program"] = program
        cache.save(kept, record)
    return record


def folder_target(mesh, folder):
    """Triangles that a folder named after a share of the input, in per cent, stands for."""
    return max(4, round(mesh.n_triangles * float(folder.name) / 100))
