// SPDX-License-Identifier: MIT
/// libFuzzer target for the readers: fuzz_reader FORMAT [libFuzzer's arguments]. FORMAT is one of
/// --format, or "packed" for compressed files of any.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/fuzz/read_all.h"

namespace {

std::string g_format;

/// A file in memory with the bytes of one input.
class MemoryFile {
  public:
    MemoryFile() : fd_(::memfd_create("fuzz", 0)) {}
    const std::string& hold(const std::uint8_t* data, std::size_t size) {
        if (::ftruncate(fd_, 0) != 0 || ::pwrite(fd_, data, size, 0) < 0) std::abort();
        return path_;
    }

  private:
    int fd_;
    std::string path_ = "/proc/self/fd/" + std::to_string(fd_);
};

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    if (*argc < 2) {
        std::fputs("usage: fuzz_reader FORMAT [ARGUMENT...]\n", stderr);
        std::exit(2);
    }
    g_format = (*argv)[1];
    if (g_format == "packed") g_format.clear();
    // libFuzzer sees the others.
    std::memmove(*argv + 1, *argv + 2, sizeof(char*) * static_cast<std::size_t>(*argc - 1));
    --*argc;
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static MemoryFile file;
    hewer::fuzz::read_all(file.hold(data, size), g_format, size % 8 == 7);
    return 0;
}
