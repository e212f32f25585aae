// SPDX-License-Identifier: MIT
/// Runs a program and tells its wall time and peak resident memory, from outside and for every
/// program in the same way.
///
///     run_measured RESULT COMMAND [ARGUMENT...]
///
/// Writes "SECONDS KIB" to the file RESULT and ends with the program's exit code (128 + signal when
/// one killed it). Seconds are from before the start to after the exit: what a caller waits for,
/// the return of the memory included.
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("usage: run_measured RESULT COMMAND [ARGUMENT...]\n", stderr);
        return 2;
    }
    const auto start = std::chrono::steady_clock::now();
    pid_t child = 0;
    const int spawn_error = posix_spawnp(&child, argv[2], nullptr, nullptr, argv + 2, environ);
    if (spawn_error != 0) {
        std::fprintf(stderr, "run_measured: %s: %s\n", argv[2], std::strerror(spawn_error));
        return 127;
    }
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child) {
        std::perror("run_measured: wait4");
        return 1;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

    std::FILE* result = std::fopen(argv[1], "w");
    if (!result) {
        std::perror(argv[1]);
        return 1;
    }
    std::fprintf(result, "%.4f %ld\n", seconds.count(), usage.ru_maxrss);
    if (std::fclose(result) != 0) {
        std::perror(argv[1]);
        return 1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
