// SPDX-License-Identifier: MIT
#include "tests/support/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hewer::test {

ScratchDir::ScratchDir() {
    std::string name = (std::filesystem::temp_directory_path() / "hewer-cli-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder");
    path_ = name;
}

ScratchDir::~ScratchDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> ScratchDir::list() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

RunningProgram::RunningProgram(const std::vector<std::string>& args,
                               const std::vector<std::string>& wrapper) {
    std::vector<std::string> words = wrapper;
    words.emplace_back(HEWER_PROGRAM);
    words.insert(words.end(), args.begin(), args.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    constexpr int kCreate = O_WRONLY | O_CREAT | O_TRUNC;
    const std::string out = scratch_.file("out");
    const std::string err = scratch_.file("err");
    ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kCreate, 0600);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kCreate, 0600);
    const int error = ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + words.front());
}

RunningProgram::~RunningProgram() {
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
}

void RunningProgram::send(int signal) const {
    ::kill(pid_, signal);
}

std::string RunningProgram::err() const {
    return read_file(scratch_.file("err"));
}

bool RunningProgram::is_over() {
    if (pid_ >= 0 && ::waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = -1;
    return pid_ < 0;
}

Outcome RunningProgram::wait() {
    if (pid_ >= 0) ::waitpid(pid_, &status_, 0);
    pid_ = -1;
    Outcome outcome;
    outcome.code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 1000 + WTERMSIG(status_);
    outcome.out = read_file(scratch_.file("out"));
    outcome.err = err();
    return outcome;
}

Outcome run_program(const std::vector<std::string>& args, const std::vector<std::string>& wrapper) {
    return RunningProgram(args, wrapper).wait();
}

std::string read_file(const std::filesystem::path& path) {
    const std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void write_file(const std::filesystem::path& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

void write_hills(const std::filesystem::path& path, unsigned n) {
    std::ofstream out(path);
    out << "ply\nformat ascii 1.0\nelement vertex " << (n + 1) * (n + 1)
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << 2 * n * n
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (unsigned i = 0; i <= n; ++i) {
        for (unsigned k = 0; k <= n; ++k) {
            const double x = static_cast<double>(i) / n;
            const double y = static_cast<double>(k) / n;
            out << x << ' ' << y << ' ' << 0.1 * std::sin(9 * x) * std::cos(7 * y) << '\n';
        }
    }
    for (unsigned i = 0; i < n; ++i) {
        for (unsigned k = 0; k < n; ++k) {
            const unsigned a = i * (n + 1) + k;
            const unsigned b = a + n + 1;
            out << "3 " << a << ' ' << b << ' ' << b + 1 << "\n3 " << a << ' ' << b + 1 << ' '
                << a + 1 << '\n';
        }
    }
}

}  // namespace hewer::test
