// SPDX-License-Identifier: MIT
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <exception>
#include <span>
#include <string>

#include "ooc/array.h"
#include "streaming/image_rows.h"
#include "streaming/range_reader.h"

namespace hewer::streaming {

namespace {

// Text and profiles beside the pixels; nobody looks at them.
constexpr png_alloc_size_t kMostChunkBytes = 1 << 20;
constexpr png_uint_32 kMostChunks = 128;
// A few rows of 16-bit RGBA, in libpng.
constexpr std::uint64_t kBytesPerColumn = 8 * 4;

class PngRows final : public ImageRows {
  public:
    PngRows(const FileRange& range, ooc::MemoryBudget& budget) : reader_(range) {
        handles_.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, pass_over);
        if (handles_.png != nullptr) handles_.info = png_create_info_struct(handles_.png);
        if (handles_.info == nullptr) throw std::bad_alloc();
        png_set_read_fn(handles_.png, this, read);
        png_set_user_limits(handles_.png, kMostSide, kMostSide);
        png_set_chunk_malloc_max(handles_.png, kMostChunkBytes);
        png_set_chunk_cache_max(handles_.png, kMostChunks);
        guarded([this] { read_header(); });
        set_size(png_get_image_width(handles_.png, handles_.info),
                 png_get_image_height(handles_.png, handles_.info));
        memory_ = budget.reserve("rows of a PNG", kBytesPerColumn * width());
        guarded([this] { choose_format(); });
        if (n_passes_ > 1) {
            whole_ = {budget, "an interlaced PNG", std::uint64_t{3} * width() * height()};
        }
    }

    [[nodiscard]] const char* format() const override { return "PNG"; }

    void read_row(std::uint8_t* rgb) override {
        if (whole_.empty()) {
            guarded([&] { png_read_row(handles_.png, rgb, nullptr); });
            return;
        }
        const std::size_t row_bytes = std::size_t{3} * width();
        if (n_read_ == 0) {
            for (int pass = 0; pass < n_passes_; ++pass) {
                for (std::size_t y = 0; y < height(); ++y) {
                    guarded([&] {
                        png_read_row(handles_.png, whole_.data() + y * row_bytes, nullptr);
                    });
                }
            }
        }
        std::memcpy(rgb, whole_.data() + n_read_++ * row_bytes, row_bytes);
    }

  private:
    struct Handles {
        Handles() = default;
        Handles(const Handles&) = delete;
        Handles& operator=(const Handles&) = delete;
        ~Handles() { png_destroy_read_struct(&png, &info, nullptr); }
        png_structp png = nullptr;
        png_infop info = nullptr;
    };

    /// Calls of libpng, which reports errors by longjmp: nothing with a destructor lives in `call`.
    template <typename Call>
    void guarded(const Call& call) {
        if (setjmp(png_jmpbuf(handles_.png)) != 0) {
            if (error_) std::rethrow_exception(error_);
            throw ImageProblem{std::string("a damaged PNG (") + message_.data() + ")"};
        }
        call();
    }
    void read_header() { png_read_info(handles_.png, handles_.info); }
    void choose_format() {
        png_structp png = handles_.png;
        png_set_expand(png);
        png_set_scale_16(png);
        png_set_gray_to_rgb(png);
        png_set_strip_alpha(png);
        n_passes_ = png_set_interlace_handling(png);
        png_read_update_info(png, handles_.info);
        if (png_get_rowbytes(png, handles_.info) != std::size_t{3} * width()) {
            png_error(png, "rows of an unknown format");
        }
    }

    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        auto* const self = static_cast<PngRows*>(png_get_error_ptr(png));
        std::strncpy(self->message_.data(), message, self->message_.size() - 1);
        png_longjmp(png, 1);
    }
    static void pass_over(png_structp /*png*/, png_const_charp /*message*/) {}
    static void read(png_structp png, png_bytep out, std::size_t n) {
        auto* const self = static_cast<PngRows*>(png_get_io_ptr(png));
        bool is_there = false;
        try {
            is_there = self->take(out, n);
        } catch (...) {
            self->error_ = std::current_exception();
        }
        if (!is_there) png_error(png, "it ends too early");
    }
    bool take(std::uint8_t* out, std::size_t n) {
        while (n > 0) {
            if (ahead_.empty()) ahead_ = reader_.next();
            if (ahead_.empty()) return false;
            const std::size_t count = std::min(n, ahead_.size());
            std::memcpy(out, ahead_.data(), count);
            ahead_ = ahead_.subspan(count);
            out += count;
            n -= count;
        }
        return true;
    }

    RangeReader reader_;
    std::span<const unsigned char> ahead_;
    Handles handles_;
    std::exception_ptr error_;
    std::array<char, 128> message_{};
    int n_passes_ = 1;
    ooc::Reservation memory_;
    ooc::Array<std::uint8_t> whole_;  // of an interlaced image
    std::size_t n_read_ = 0;
};

}  // namespace

std::unique_ptr<ImageRows> open_png(const FileRange& range, ooc::MemoryBudget& budget) {
    return std::make_unique<PngRows>(range, budget);
}

}  // namespace hewer::streaming
