// SPDX-License-Identifier: MIT
// jpeglib.h wants size_t and FILE before it.
#include <cstddef>
#include <cstdio>
//
#include <jpeglib.h>

#include <array>
#include <csetjmp>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "streaming/image_rows.h"
#include "streaming/range_reader.h"

namespace hewer::streaming {

namespace {

// Scans of a progressive image: encoders make about ten; thousands are an attack on the time.
constexpr int kMostScans = 200;
// Rows of blocks before and after scaling and colour conversion, in libjpeg.
constexpr std::uint64_t kBytesPerColumn = 256;
constexpr std::array<JOCTET, 2> kEndOfImage{0xff, JPEG_EOI};

class JpegRows final : public ImageRows {
  public:
    JpegRows(const FileRange& range, ooc::MemoryBudget& budget) : reader_(range) {
        c_.err = jpeg_std_error(&handler_);
        c_.client_data = this;
        handler_.error_exit = fail;
        handler_.emit_message = note;
        handler_.output_message = [](j_common_ptr) {};
        source_.init_source = [](j_decompress_ptr) {};
        source_.fill_input_buffer = fill;
        source_.skip_input_data = skip;
        source_.resync_to_restart = jpeg_resync_to_restart;
        source_.term_source = [](j_decompress_ptr) {};
        progress_.progress_monitor = watch;
        guarded([this] {
            jpeg_create_decompress(&c_);
            c_.src = &source_;
            c_.progress = &progress_;
            jpeg_read_header(&c_, TRUE);
        });
        set_size(c_.image_width, c_.image_height);
        std::uint64_t bytes = kBytesPerColumn * width();
        if (jpeg_has_multiple_scans(&c_) != 0) {
            for (int i = 0; i < c_.num_components; ++i) {
                const jpeg_component_info& component = c_.comp_info[i];
                bytes += std::uint64_t{component.width_in_blocks} * component.height_in_blocks *
                         sizeof(JBLOCK);
            }
        }
        memory_ = budget.reserve("a JPEG", bytes);
        has_black_ = c_.num_components == 4;
        c_.out_color_space = has_black_ ? JCS_CMYK : JCS_RGB;
        // The slow one is exact: the same on every machine.
        c_.dct_method = JDCT_ISLOW;
        if (has_black_) inks_.resize(std::size_t{4} * width());
        guarded([this] { jpeg_start_decompress(&c_); });
        // Whether scans are missing cannot be told otherwise.
        if (is_at_end_ && jpeg_has_multiple_scans(&c_) != 0) {
            throw ImageProblem{"a damaged JPEG (it ends too early)"};
        }
    }
    JpegRows(const JpegRows&) = delete;
    JpegRows& operator=(const JpegRows&) = delete;

    [[nodiscard]] const char* format() const override { return "JPEG"; }

    void read_row(std::uint8_t* rgb) override {
        JSAMPROW row = has_black_ ? inks_.data() : rgb;
        guarded([&] { jpeg_read_scanlines(&c_, &row, 1); });
        if (has_black_) mix(rgb);
    }

  private:
    /// Calls of libjpeg, which reports errors by longjmp: nothing with a destructor lives in
    /// `call`.
    template <typename Call>
    void guarded(const Call& call) {
        if (setjmp(jump_) != 0) {
            if (error_) std::rethrow_exception(error_);
            throw ImageProblem{std::string("a damaged JPEG (") + message_.data() + ")"};
        }
        call();
    }

    /// Four inks to light, without a profile. Adobe's programs store them inverted.
    void mix(std::uint8_t* rgb) const {
        for (std::size_t x = 0; x < width(); ++x) {
            const std::uint8_t* const ink = inks_.data() + 4 * x;
            for (std::size_t k = 0; k < 3; ++k) {
                const bool is_inverted = c_.saw_Adobe_marker != 0;
                const int light = is_inverted ? ink[k] : 255 - ink[k];
                const int paper = is_inverted ? ink[3] : 255 - ink[3];
                rgb[3 * x + k] = static_cast<std::uint8_t>((light * paper + 127) / 255);
            }
        }
    }

    static JpegRows& self(j_common_ptr c) { return *static_cast<JpegRows*>(c->client_data); }
    static JpegRows& self(j_decompress_ptr c) { return *static_cast<JpegRows*>(c->client_data); }

    [[noreturn]] static void fail(j_common_ptr c) {
        JpegRows& rows = self(c);
        c->err->format_message(c, rows.message_.data());
        std::longjmp(rows.jump_, 1);
    }
    /// Viewers make up what is missing; here that would be colours that the surface does not have.
    static void note(j_common_ptr c, int level) {
        if (level < 0 && self(c).is_at_end_) fail(c);
    }
    static boolean fill(j_decompress_ptr c) {
        JpegRows& rows = self(c);
        std::span<const unsigned char> piece;
        bool has_failed = false;
        try {
            piece = rows.reader_.next();
        } catch (...) {
            rows.error_ = std::current_exception();
            has_failed = true;
        }
        if (has_failed) std::longjmp(rows.jump_, 1);
        // Some writers leave the mark at the end out: that alone is no damage.
        if (piece.empty()) {
            rows.is_at_end_ = true;
            piece = kEndOfImage;
        }
        rows.source_.next_input_byte = piece.data();
        rows.source_.bytes_in_buffer = piece.size();
        return TRUE;
    }
    static void skip(j_decompress_ptr c, long n) {
        JpegRows& rows = self(c);
        auto left = static_cast<std::size_t>(n > 0 ? n : 0);
        while (left > rows.source_.bytes_in_buffer && !rows.is_at_end_) {
            left -= rows.source_.bytes_in_buffer;
            fill(c);
        }
        left = left < rows.source_.bytes_in_buffer ? left : rows.source_.bytes_in_buffer;
        rows.source_.next_input_byte += left;
        rows.source_.bytes_in_buffer -= left;
    }
    static void watch(j_common_ptr c) {
        const JpegRows& rows = self(c);
        if (rows.c_.input_scan_number <= kMostScans) return;
        std::snprintf(self(c).message_.data(), JMSG_LENGTH_MAX, "more than %d scans", kMostScans);
        std::longjmp(self(c).jump_, 1);
    }

    struct Handle : jpeg_decompress_struct {
        Handle() : jpeg_decompress_struct{} {}
        Handle(const Handle&) = delete;
        Handle& operator=(const Handle&) = delete;
        ~Handle() { jpeg_destroy_decompress(this); }
    };

    RangeReader reader_;
    jpeg_error_mgr handler_{};
    jpeg_source_mgr source_{};
    jpeg_progress_mgr progress_{};
    Handle c_;
    std::jmp_buf jump_{};
    std::exception_ptr error_;
    std::array<char, JMSG_LENGTH_MAX> message_{};
    bool is_at_end_ = false;
    bool has_black_ = false;
    std::vector<std::uint8_t> inks_;
    ooc::Reservation memory_;
};

}  // namespace

std::unique_ptr<ImageRows> open_jpeg(const FileRange& range, ooc::MemoryBudget& budget) {
    return std::make_unique<JpegRows>(range, budget);
}

}  // namespace hewer::streaming
