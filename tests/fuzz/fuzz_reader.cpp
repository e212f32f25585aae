// SPDX-License-Identifier: MIT
/// libFuzzer target for the readers: fuzz_reader FORMAT [libFuzzer's arguments]. FORMAT is one of
/// --format, or "packed" for compressed files of any.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fuzz/read_all.h"

namespace {

std::string g_format;

/// A file in memory with the bytes of one input, in a folder that has a texture, t.png, and a
/// material that uses it, "m" of m.mtl.
class MemoryFile {
  public:
    MemoryFile() : fd_(::memfd_create("fuzz", 0)) {
        // One texel.
        constexpr std::array<unsigned char, 69> kPng{
            0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
            0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
            0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78,
            0x9c, 0x63, 0xf8, 0xdf, 0xc0, 0x00, 0x00, 0x04, 0x01, 0x01, 0x80, 0xc5, 0x2a, 0x18,
            0x5d, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "t.png", std::ios::binary)
            .write(reinterpret_cast<const char*>(kPng.data()), kPng.size());
        std::ofstream(folder_ / "m.mtl") << "newmtl m\nmap_Kd t.png\n";
        std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(fd_), path_);
    }
    ~MemoryFile() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    const std::filesystem::path& hold(const std::uint8_t* data, std::size_t size) {
        if (::ftruncate(fd_, 0) != 0 || ::pwrite(fd_, data, size, 0) < 0) std::abort();
        return path_;
    }

  private:
    int fd_;
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("hewer-fuzz-" + std::to_string(::getpid()));
    std::filesystem::path path_ = folder_ / "input";
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
