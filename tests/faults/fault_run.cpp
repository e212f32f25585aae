// SPDX-License-Identifier: MIT
#include "tests/faults/fault_run.h"

#include <gtest/gtest.h>
#include <sys/mount.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace hewer::test {

namespace {

namespace fs = std::filesystem;

void run_or_throw(const Args& args) {
    const Outcome outcome = run_program(args);
    if (outcome.code != 0) throw std::runtime_error(outcome.err);
}

void make_scan(const std::string& path, const Args& rest) {
    Args args{"generate", path, "--quiet"};
    args.insert(args.end(), rest.begin(), rest.end());
    run_or_throw(args);
}

/// An ASCII PLY with double positions of 80,000 triangles.
void make_doubles(const std::string& path) {
    write_hills(path, 200);
    std::string text = read_file(path);
    for (const char axis : {'x', 'y', 'z'}) {
        const std::string property = std::string("property float ") + axis;
        text.replace(text.find(property), property.size(), std::string("property double ") + axis);
    }
    write_file(path, text);
}

Args simplify(const FaultRun& run, const std::string& input, const Args& rest) {
    Args args{"simplify",   input, "-o",         run.outputs.file("out.ply"),
              "--threads",  "2",   "--temp-dir", run.temp.path(),
              "--progress", "json"};
    args.insert(args.end(), rest.begin(), rest.end());
    return args;
}

}  // namespace

std::map<std::string, std::string> FaultRun::results() const {
    std::map<std::string, std::string> files;
    for (const std::string& name : outputs.list()) files[name] = read_file(outputs.file(name));
    return files;
}

void FaultRun::remove_results() const {
    for (const std::string& name : outputs.list()) fs::remove(outputs.file(name));
}

std::string name_of(Job job) {
    switch (job) {
        case Job::Levels:
            return "levels";
        case Job::Shuffled:
            return "shuffled";
        case Job::Full:
            return "full";
        case Job::Soup:
            return "soup";
        case Job::Doubles:
            return "doubles";
        case Job::Generate:
            return "generate";
        case Job::Measure:
            return "measure";
    }
    return {};
}

void PrintTo(Job job, std::ostream* out) {
    *out << name_of(job);
}

void prepare(Job job, FaultRun& run) {
    const std::string scan = run.inputs.file("scan.ply");
    switch (job) {
        case Job::Levels:
            make_scan(scan, {"--triangles", "140k", "--color"});
            run.args = simplify(run, scan, {"--lods", "84k,20k", "--memory", "66MiB"});
            return;
        case Job::Shuffled:
            make_scan(scan, {"--triangles", "600k", "--shuffle"});
            run.args = simplify(run, scan, {"--triangles", "100k", "--memory", "56MiB"});
            return;
        case Job::Full:
            make_scan(scan, {"--triangles", "150k", "--holes"});
            run.args = simplify(run, scan,
                                {"--triangles", "100k", "--memory", "56MiB", "--method", "full"});
            return;
        case Job::Soup: {
            const std::string soup = run.inputs.file("scan.stl");
            make_scan(scan, {"--triangles", "170k"});
            run_or_throw({"simplify", scan, "-o", soup, "--triangles", "170k", "--quiet"});
            run.args = simplify(run, soup, {"--triangles", "85k", "--memory", "56MiB"});
            return;
        }
        case Job::Doubles:
            make_doubles(scan);
            run.args = simplify(run, scan, {"--triangles", "60k", "--memory", "55MiB"});
            return;
        case Job::Generate:
            run.args = {"generate",    run.outputs.file("out.ply"),
                        "--triangles", "2M",
                        "--holes",     "--progress",
                        "json"};
            return;
        case Job::Measure: {
            const std::string coarse = run.inputs.file("coarse.ply");
            make_scan(scan, {"--triangles", "100k"});
            make_scan(coarse, {"--triangles", "10k"});
            run.args = {"measure",    scan,  coarse, "--report", run.outputs.file("report.json"),
                        "--progress", "json"};
            return;
        }
    }
}

std::vector<std::string> stages_begun(const std::string& err) {
    std::vector<std::string> stages;
    std::istringstream lines(err.substr(0, err.rfind('\n') + 1));
    for (std::string text; std::getline(lines, text);) {
        const auto line = nlohmann::json::parse(text, nullptr, false);
        if (!line.is_object() || !line.contains("stage")) continue;  // a warning, an error
        const std::string stage = line["stage"];
        if (stages.empty() || stages.back() != stage) stages.push_back(stage);
    }
    return stages;
}

void wait_for_stage(RunningProgram& program, std::size_t n) {
    // Reading the same lines again would take a core from the program.
    std::size_t n_read = 0;
    while (!program.is_over()) {
        const std::string err = program.err();
        if (err.size() > n_read && stages_begun(err).size() >= n) return;
        n_read = err.size();
        std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
}

SmallDisk::SmallDisk(const ScratchDir& folder, const std::string& size)
    : folder_(folder.path()),
      is_there_(::mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0) {}

SmallDisk::~SmallDisk() {
    if (is_there_) ::umount(folder_.c_str());
}

}  // namespace hewer::test
