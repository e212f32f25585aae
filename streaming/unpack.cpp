// SPDX-License-Identifier: MIT
#include "streaming/unpack.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/context.h"
#include "ooc/io_error.h"
#include "ooc/units.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

constexpr std::size_t kInBytes = 128 << 10;
constexpr std::size_t kOutBytes = 1 << 20;
// zlib's own state for decompression.
constexpr std::uint64_t kZlibBytes = 64 << 10;

ooc::ResourceLimits limits_of(const OpenOptions& options) {
    return {.memory_bytes = options.memory_bytes, .n_threads = 1};
}

/// Bytes of a file from front to back, with progress.
class Feed {
  public:
    Feed(const ooc::InputFile& file, ooc::Context& context)
        : file_(file), context_(context), bytes_(kInBytes) {
        context.begin_stage("unpack", file.size(), "bytes");
    }
    /// The next bytes; none at the end.
    std::span<unsigned char> next() {
        const std::size_t n = file_.read_at(offset_, bytes_.data(), bytes_.size());
        offset_ += n;
        context_.advance(n);
        return {bytes_.data(), n};
    }
    [[nodiscard]] std::string place(std::size_t n_left) const {
        return file_.path().string() + ": byte " + std::to_string(offset_ - n_left) + ": ";
    }

  private:
    const ooc::InputFile& file_;
    ooc::Context& context_;
    std::vector<unsigned char> bytes_;
    std::uint64_t offset_ = 0;
};

class GzipStream {
  public:
    GzipStream() {
        // 15: the largest window; 16: gzip, not zlib.
        if (::inflateInit2(&z_, 15 + 16) != Z_OK) throw InternalError("zlib does not start");
    }
    GzipStream(const GzipStream&) = delete;
    GzipStream& operator=(const GzipStream&) = delete;
    ~GzipStream() { ::inflateEnd(&z_); }
    z_stream* operator->() { return &z_; }
    z_stream* get() { return &z_; }

  private:
    z_stream z_{};
};

struct FreeZstd {
    void operator()(ZSTD_DStream* stream) const { ::ZSTD_freeDStream(stream); }
};

}  // namespace

std::unique_ptr<ooc::InputFile> unpack_gzip(const ooc::InputFile& file, const OpenOptions& options,
                                            const Hooks& hooks, std::uint64_t wanted_bytes) {
    ooc::Context context(limits_of(options), hooks, {{"unpack", 1}});
    const auto memory =
        context.budget().reserve("decompression", kInBytes + kOutBytes + kZlibBytes);
    TemporaryInput unpacked(options);
    Feed feed(file, context);
    GzipStream z;
    std::vector<unsigned char> out(kOutBytes);
    bool is_at_end_of_member = false;
    bool is_padding = false;
    bool is_first_member = true;
    for (std::span<unsigned char> in = feed.next(); !in.empty(); in = feed.next()) {
        z->next_in = in.data();
        z->avail_in = static_cast<uInt>(in.size());
        while (z->avail_in > 0 && !is_padding) {
            if (is_at_end_of_member) {
                // Another member, or the zeros that tapes and some tools pad with.
                is_padding = *z->next_in == 0;
                if (is_padding) break;
                ::inflateReset(z.get());
                is_first_member = false;
            }
            do {
                z->next_out = out.data();
                z->avail_out = static_cast<uInt>(out.size());
                const int result = ::inflate(z.get(), Z_NO_FLUSH);
                const bool is_damaged =
                    result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR;
                if (is_damaged && !is_first_member && z->total_out == 0) {
                    // As gzip does: what does not begin like another member is none.
                    if (options.strict) {
                        throw FormatError(feed.place(z->avail_in) +
                                          "bytes behind the gzip data; strict mode refuses them");
                    }
                    context.warn(feed.place(z->avail_in) +
                                 "what follows the gzip data here is not read");
                    return unpacked.finish(file.path());
                }
                if (is_damaged) {
                    throw FormatError(feed.place(z->avail_in) + "the gzip data is damaged" +
                                      (z->msg != nullptr ? std::string(" (") + z->msg + ")" : "") +
                                      "; compress it again from the original");
                }
                unpacked.append(out.data(), out.size() - z->avail_out);
                if (unpacked.size() >= wanted_bytes) return unpacked.finish(file.path());
                is_at_end_of_member = result == Z_STREAM_END;
            } while (!is_at_end_of_member && z->avail_out == 0);
        }
    }
    if (!is_at_end_of_member) {
        throw FormatError(feed.place(0) + "the gzip data ends too early; the file is cut short");
    }
    context.end_stage();
    return unpacked.finish(file.path());
}

std::unique_ptr<ooc::InputFile> unpack_zstd(const ooc::InputFile& file, const OpenOptions& options,
                                            const Hooks& hooks, std::uint64_t wanted_bytes) {
    ooc::Context context(limits_of(options), hooks, {{"unpack", 1}});
    const auto memory = context.budget().reserve("decompression", kInBytes + kOutBytes);
    TemporaryInput unpacked(options);
    Feed feed(file, context);
    const std::unique_ptr<ZSTD_DStream, FreeZstd> z(::ZSTD_createDStream());
    if (!z) throw InternalError("zstd does not start");
    // A frame says how large a window it wants; one that does not fit is refused before it is made.
    constexpr int kLeastLog = 10;
    constexpr int kMostLog = 31;
    const std::uint64_t available = context.budget().available();
    const int most_log =
        std::clamp(static_cast<int>(std::bit_width(available)) - 2, kLeastLog, kMostLog);
    ::ZSTD_DCtx_setParameter(z.get(), ZSTD_d_windowLogMax, most_log);
    ooc::Reservation window;
    std::vector<unsigned char> out(kOutBytes);
    std::size_t hint = 1;  // 0: at the end of a frame
    for (std::span<unsigned char> in = feed.next(); !in.empty(); in = feed.next()) {
        ZSTD_inBuffer input{in.data(), in.size(), 0};
        bool has_more = true;
        while (input.pos < input.size || has_more) {
            ZSTD_outBuffer output{out.data(), out.size(), 0};
            const std::size_t consumed = input.pos;
            hint = ::ZSTD_decompressStream(z.get(), &output, &input);
            if (::ZSTD_getErrorCode(hint) == ZSTD_error_frameParameter_windowTooLarge) {
                const std::string enough = std::to_string((context.budget().used() >> 20) +
                                                          (std::uint64_t{4} << most_log >> 20)) +
                                           " MiB";
                throw OutOfMemoryBudget(feed.place(input.size - input.pos) +
                                        "the Zstandard data was compressed with a window that does "
                                        "not fit the limit of " +
                                        ooc::format_bytes(context.budget().limit()) +
                                        "; raise --memory to " + enough +
                                        " or more, or unpack it first");
            }
            if (::ZSTD_isError(hint) != 0) {
                throw FormatError(feed.place(input.size - input.pos) +
                                  "the Zstandard data is damaged (" + ::ZSTD_getErrorName(hint) +
                                  "); compress it again from the original");
            }
            const std::uint64_t held_bytes = ::ZSTD_sizeof_DStream(z.get());
            if (held_bytes > window.bytes()) {
                window.release();
                window = context.budget().reserve("window of the Zstandard data", held_bytes);
            }
            if (output.pos > 0) unpacked.append(out.data(), output.pos);
            if (unpacked.size() >= wanted_bytes) return unpacked.finish(file.path());
            has_more = output.pos == output.size;
            if (!has_more && input.pos == consumed && input.pos < input.size && output.pos == 0) {
                break;  // no progress: needs the next piece
            }
        }
    }
    if (hint != 0) {
        throw FormatError(feed.place(0) +
                          "the Zstandard data ends too early; the file is cut short");
    }
    context.end_stage();
    return unpacked.finish(file.path());
}

bool is_pipe(const std::filesystem::path& path) {
    struct stat st {};
    const int result = path == "-" ? ::fstat(STDIN_FILENO, &st) : ::stat(path.c_str(), &st);
    return result == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

std::unique_ptr<ooc::InputFile> spool_pipe(const std::filesystem::path& path,
                                           const OpenOptions& options, const Hooks& hooks) {
    ooc::Context context(limits_of(options), hooks, {{"read", 1}});
    const auto memory = context.budget().reserve("pipe", kOutBytes);
    const bool is_standard = path == "-";
    const std::filesystem::path name = is_standard ? "standard input" : path;
    const int fd = is_standard ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) ooc::throw_io_error(name, "open", errno);
    struct Close {
        int fd;
        ~Close() {
            if (fd >= 0) ::close(fd);
        }
    } const close{is_standard ? -1 : fd};
    TemporaryInput unpacked(options);
    std::vector<unsigned char> bytes(kOutBytes);
    context.begin_stage("read", 0, "bytes");
    std::size_t used = 0;
    for (;;) {
        const ssize_t n = ::read(fd, bytes.data() + used, bytes.size() - used);
        if (n < 0 && errno == EINTR) {
            context.check_stop();
            continue;
        }
        if (n < 0) ooc::throw_io_error(name, "read", errno);
        used += static_cast<std::size_t>(n);
        context.advance(static_cast<std::uint64_t>(n));
        if (n > 0 && used < bytes.size()) continue;
        if (used > 0) unpacked.append(bytes.data(), used);
        used = 0;
        if (n == 0) break;
    }
    context.end_stage();
    return unpacked.finish(name);
}

}  // namespace hewer::streaming
