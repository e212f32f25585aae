// SPDX-License-Identifier: MIT
#include "streaming/ply_header.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

std::optional<ScalarType> scalar_type(std::string_view name) {
    static constexpr std::array<std::pair<std::string_view, ScalarType>, 30> kNames{{
        {"char", ScalarType::Int8},      {"int8", ScalarType::Int8},
        {"int8_t", ScalarType::Int8},    {"uchar", ScalarType::UInt8},
        {"uint8", ScalarType::UInt8},    {"uint8_t", ScalarType::UInt8},
        {"short", ScalarType::Int16},    {"int16", ScalarType::Int16},
        {"int16_t", ScalarType::Int16},  {"ushort", ScalarType::UInt16},
        {"uint16", ScalarType::UInt16},  {"uint16_t", ScalarType::UInt16},
        {"int", ScalarType::Int32},      {"int32", ScalarType::Int32},
        {"int32_t", ScalarType::Int32},  {"uint", ScalarType::UInt32},
        {"uint32", ScalarType::UInt32},  {"uint32_t", ScalarType::UInt32},
        {"int64", ScalarType::Int64},    {"int64_t", ScalarType::Int64},
        {"longlong", ScalarType::Int64}, {"long", ScalarType::Int64},
        {"uint64", ScalarType::UInt64},  {"uint64_t", ScalarType::UInt64},
        {"ulong", ScalarType::UInt64},   {"ulonglong", ScalarType::UInt64},
        {"float", ScalarType::Float32},  {"float32", ScalarType::Float32},
        {"double", ScalarType::Float64}, {"float64", ScalarType::Float64},
    }};
    const auto* found = std::find_if(kNames.begin(), kNames.end(),
                                     [&](const auto& entry) { return entry.first == name; });
    if (found == kNames.end()) return std::nullopt;
    return found->second;
}

/// The header's bytes, line by line.
class HeaderLines {
  public:
    explicit HeaderLines(const ooc::InputFile& file) : file_(file) {
        extend();
        const std::size_t end = text_.find_first_of("\r\n");
        // CR alone ends lines only if it does so on the first one: a CR before LF belongs to it.
        if (end != std::string::npos && text_[end] == '\r' && text_.compare(end, 2, "\r\n") != 0) {
            line_end_ = '\r';
        }
    }

    /// The next line without its end and split at blanks.
    std::vector<std::string_view> next() {
        std::size_t end = text_.find(line_end_, position_);
        while (end == std::string::npos) {
            // Views of earlier lines are not used any more.
            if (!extend()) fail_without_end();
            end = text_.find(line_end_, position_);
        }
        std::string_view line(text_.data() + position_, end - position_);
        position_ = end + 1;
        ++n_lines_;
        std::vector<std::string_view> words;
        while (true) {
            const std::size_t first = line.find_first_not_of(" \t\r");
            if (first == std::string_view::npos) return words;
            line.remove_prefix(first);
            const std::size_t last = std::min(line.find_first_of(" \t\r"), line.size());
            words.push_back(line.substr(0, last));
            line.remove_prefix(last);
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw FormatError(file_.path().string() + ": line " + std::to_string(n_lines_) +
                          " of the PLY header: " + what);
    }
    [[nodiscard]] std::uint64_t n_bytes() const { return position_; }
    [[nodiscard]] std::uint64_t n_lines() const { return n_lines_; }

  private:
    bool extend() {
        constexpr std::size_t kChunk = 1 << 16;
        const std::size_t old_size = text_.size();
        if (old_size >= kMaxPlyHeaderBytes) return false;
        text_.resize(old_size + kChunk);
        const std::size_t got = file_.read_at(old_size, text_.data() + old_size, kChunk);
        text_.resize(old_size + got);
        return got > 0;
    }
    [[noreturn]] void fail_without_end() const {
        const std::string path = file_.path().string();
        if (text_.size() >= kMaxPlyHeaderBytes) {
            throw FormatError(path + ": no end_header within the first " +
                              ooc::format_bytes(kMaxPlyHeaderBytes) +
                              "; this is not a PLY header that hewer reads");
        }
        throw FormatError(path + ": the PLY header has no end_header line; the file ends at byte " +
                          std::to_string(text_.size()) + ", after line " +
                          std::to_string(n_lines_));
    }

    const ooc::InputFile& file_;
    std::string text_;
    std::size_t position_ = 0;
    std::uint64_t n_lines_ = 0;
    char line_end_ = '\n';
};

PlyEncoding parse_format(const HeaderLines& lines, const std::vector<std::string_view>& words) {
    if (words.size() < 2) lines.fail("the format is missing");
    if (words[1] == "ascii") return PlyEncoding::Ascii;
    if (words[1] == "binary_little_endian") return PlyEncoding::LittleEndian;
    if (words[1] == "binary_big_endian") return PlyEncoding::BigEndian;
    lines.fail("unknown format '" + std::string(words[1]) +
               "' (known: ascii, binary_little_endian, binary_big_endian)");
}

PlyElement parse_element(const HeaderLines& lines, const std::vector<std::string_view>& words,
                         const PlyHeader& header) {
    if (words.size() != 3) lines.fail("an element line reads 'element NAME COUNT'");
    PlyElement element;
    element.name = words[1];
    const std::string_view text = words[2];
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), element.count);
    if (error != std::errc() || end != text.data() + text.size()) {
        lines.fail("element " + element.name + " has the count '" + std::string(text) +
                   "', which is " +
                   (text.front() == '-' ? "negative" : "not a whole number below 2^64"));
    }
    if (header.find(element.name) != nullptr) {
        lines.fail("a second element '" + element.name + "'");
    }
    return element;
}

PlyProperty parse_property(const HeaderLines& lines, const std::vector<std::string_view>& words) {
    const bool is_list = words.size() > 1 && words[1] == "list";
    if (words.size() != (is_list ? 5U : 3U)) {
        lines.fail("a property line reads 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }
    const auto type = [&](std::string_view name) {
        const std::optional<ScalarType> found = scalar_type(name);
        if (!found) lines.fail("unknown type '" + std::string(name) + "'");
        return *found;
    };
    PlyProperty property;
    property.name = words.back();
    property.is_list = is_list;
    property.type = type(words[words.size() - 2]);
    if (is_list) {
        property.count_type = type(words[2]);
        if (!is_integer(property.count_type)) {
            lines.fail("the length of list '" + property.name + "' has the type '" +
                       std::string(words[2]) + "'; a whole number is needed");
        }
    }
    return property;
}

/// Names may have blanks in them.
void parse_comment(const std::vector<std::string_view>& words, PlyHeader& header) {
    if (words.size() < 3 || words[1] != "TextureFile") return;
    const char* const end = words.back().data() + words.back().size();
    header.texture_files.emplace_back(words[2].data(), end);
}

}  // namespace

bool PlyElement::has_lists() const {
    return std::any_of(properties.begin(), properties.end(),
                       [](const PlyProperty& p) { return p.is_list; });
}

const PlyElement* PlyHeader::find(const std::string& name) const {
    const auto found = std::find_if(elements.begin(), elements.end(),
                                    [&](const PlyElement& e) { return e.name == name; });
    return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(const ooc::InputFile& file) {
    HeaderLines lines(file);
    PlyHeader header;
    bool has_format = false;
    (void)lines.next();  // "ply": the caller has looked
    while (true) {
        const std::vector<std::string_view> words = lines.next();
        if (words.empty() || words[0] == "obj_info") continue;
        if (words[0] == "end_header") break;
        if (words[0] == "comment") {
            parse_comment(words, header);
        } else if (words[0] == "format") {
            header.encoding = parse_format(lines, words);
            has_format = true;
        } else if (words[0] == "element") {
            header.elements.push_back(parse_element(lines, words, header));
        } else if (words[0] == "property") {
            if (header.elements.empty()) lines.fail("a property before any element");
            header.elements.back().properties.push_back(parse_property(lines, words));
        } else {
            lines.fail("unknown keyword '" + std::string(words[0].substr(0, 40)) + "'");
        }
    }
    if (!has_format) lines.fail("there is no format line");
    header.n_bytes = lines.n_bytes();
    header.n_lines = lines.n_lines();
    return header;
}

}  // namespace hewer::streaming
