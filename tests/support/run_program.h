// SPDX-License-Identifier: MIT
/// Runs the real program as a user would, for tests.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace hewer::test {

/// A folder that goes away with the object.
class ScratchDir {
  public:
    ScratchDir();
    ScratchDir(const ScratchDir&) = delete;
    ScratchDir& operator=(const ScratchDir&) = delete;
    ~ScratchDir();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string file(const std::string& name) const { return path_ / name; }
    /// Sorted names of all that is in it.
    [[nodiscard]] std::vector<std::string> list() const;

  private:
    std::filesystem::path path_;
};

struct Outcome {
    int code = -1;  ///< exit code; 1000 + n if signal n ended the program
    std::string out;
    std::string err;
};

/// The program in the background, its output kept in files of its own.
class RunningProgram {
  public:
    /// With `wrapper`, that command is run instead, the program and its arguments behind its own.
    explicit RunningProgram(const std::vector<std::string>& args,
                            const std::vector<std::string>& wrapper = {});
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;
    ~RunningProgram();

    void send(int signal) const;
    /// What it has written to standard error so far.
    [[nodiscard]] std::string err() const;
    [[nodiscard]] bool is_over();
    Outcome wait();

  private:
    ScratchDir scratch_;
    pid_t pid_ = -1;
    int status_ = 0;
};

Outcome run_program(const std::vector<std::string>& args,
                    const std::vector<std::string>& wrapper = {});

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& content);

/// ASCII PLY of a bumpy square of 2 * n * n triangles.
void write_hills(const std::filesystem::path& path, unsigned n);

}  // namespace hewer::test
