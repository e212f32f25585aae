// SPDX-License-Identifier: MIT
#include "streaming/gltf_document.h"

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "hewer/error.h"
#include "ooc/memory_budget.h"
#include "streaming/scalar_type.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"
constexpr std::uint64_t kFileHeaderBytes = 12;
constexpr std::uint64_t kChunkHeaderBytes = 8;
constexpr std::uint64_t kJsonMemory = 24;
// Deeper than any document; both parsers recurse.
constexpr int kMostDepth = 256;

/// Where JSON and binary chunk of a GLB file are.
struct Chunks {
    std::uint64_t json_offset = 0;
    std::uint64_t json_bytes = 0;
    std::uint64_t bin_offset = 0;
    std::uint64_t bin_bytes = 0;
    std::uint64_t trailing_bytes = 0;
};

std::uint32_t word_at(const ooc::InputFile& file, std::uint64_t offset) {
    std::array<unsigned char, 4> bytes{};
    if (file.read_at(offset, bytes.data(), bytes.size()) < bytes.size()) {
        throw FormatError(file.path().string() + ": truncated GLB: it ends at byte " +
                          std::to_string(file.size()));
    }
    return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
           std::uint32_t{bytes[3]} << 24;
}

Chunks find_chunks(const ooc::InputFile& file) {
    const std::string name = file.path().string();
    if (word_at(file, 0) != kMagic) throw FormatError(name + ": byte 0: no GLB begins like this");
    if (const std::uint32_t version = word_at(file, 4); version != 2) {
        throw FormatError(name + ": GLB of version " + std::to_string(version) +
                          "; hewer reads version 2");
    }
    Chunks chunks;
    const std::uint64_t end = file.size();
    // Where the header says that it ends, if that is between two chunks: some writers say nonsense.
    const std::uint64_t announced = word_at(file, 8);
    for (std::uint64_t at = kFileHeaderBytes; at + kChunkHeaderBytes <= end;) {
        if (at == announced) {
            chunks.trailing_bytes = end - at;
            break;
        }
        const std::uint64_t n = word_at(file, at);
        const std::uint32_t type = word_at(file, at + 4);
        const std::uint64_t begin = at + kChunkHeaderBytes;
        if (n > end - begin) {
            throw FormatError(name + ": truncated GLB: the chunk at byte " + std::to_string(at) +
                              " needs " + std::to_string(n) + " bytes, the file ends at byte " +
                              std::to_string(end));
        }
        if (type == kJsonChunk && chunks.json_bytes == 0) {
            chunks.json_offset = begin;
            chunks.json_bytes = n;
        } else if (type == kBinChunk && chunks.bin_bytes == 0) {
            chunks.bin_offset = begin;
            chunks.bin_bytes = n;
        }
        at = begin + n;
    }
    if (chunks.json_bytes == 0) throw FormatError(name + ": this GLB has no JSON chunk");
    return chunks;
}

Json parse(const std::string& text, const std::string& name) {
    bool is_too_deep = false;
    const Json::parser_callback_t check = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > kMostDepth) is_too_deep = true;
        return !is_too_deep;
    };
    try {
        Json document = Json::parse(text, check);
        if (is_too_deep) throw FormatError(name + ": the JSON is nested too deeply for a glTF");
        if (!document.is_object()) throw FormatError(name + ": the JSON of a glTF is an object");
        return document;
    } catch (const Json::exception& e) {
        throw FormatError(name + ": the JSON is damaged: " + e.what());
    }
}

/// "a%20b" -> "a b"
std::string percent_decoded(const std::string& text) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        if (c >= 'A' && c <= 'F') return c - 'A' + 10;
        return -1;
    };
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_code = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 &&
                             digit(text[i + 2]) >= 0;
        if (is_code) {
            result += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
            i += 2;
        } else {
            result += text[i];
        }
    }
    return result;
}

/// Appends the bytes that `text` encodes in base 64. False if it is damaged.
bool append_base64(std::string_view text, TemporaryInput& out) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<unsigned char> piece;
    constexpr std::size_t kPiece = 64 << 10;
    piece.reserve(kPiece + 3);
    std::uint32_t bits = 0;
    unsigned n_bits = 0;
    for (const char c : text) {
        std::uint32_t value = 0;
        if (c >= 'A' && c <= 'Z') {
            value = static_cast<std::uint32_t>(c - 'A');
        } else if (c >= 'a' && c <= 'z') {
            value = static_cast<std::uint32_t>(c - 'a') + 26;
        } else if (c >= '0' && c <= '9') {
            value = static_cast<std::uint32_t>(c - '0') + 52;
        } else if (c == '+' || c == '-') {
            value = 62;
        } else if (c == '/' || c == '_') {
            value = 63;
        } else {
            return false;
        }
        bits = bits << 6 | value;
        n_bits += 6;
        if (n_bits < 8) continue;
        n_bits -= 8;
        piece.push_back(static_cast<unsigned char>(bits >> n_bits));
        if (piece.size() < kPiece) continue;
        out.append(piece.data(), piece.size());
        piece.clear();
    }
    out.append(piece.data(), piece.size());
    return true;
}

/// What a `data:` URI holds, in a temporary file.
FileRange unpack(GltfDocument& document, const std::string& uri, const std::string& what,
                 const OpenOptions& options) {
    const std::size_t comma = uri.find(',');
    const bool is_base64 = comma != uri.npos && uri.substr(0, comma).find(";base64") != uri.npos;
    TemporaryInput out(beside(options, document.held_temp_bytes));
    if (!is_base64 || !append_base64(std::string_view(uri).substr(comma + 1), out)) {
        throw FormatError(what + ": its data: uri is damaged");
    }
    const std::uint64_t size = out.size();
    document.held_temp_bytes += size;
    return {out.finish(document.name), 0, size};
}

/// What an address in the document leads to.
FileRange find_uri(GltfDocument& document, const std::string& uri, const std::string& what,
                   const OpenOptions& options) {
    if (uri.starts_with("data:")) return unpack(document, uri, what, options);
    if (uri.find("://") != std::string::npos) {
        throw FormatError(what + " is at " + uri + "; fetch it and name the file");
    }
    const std::filesystem::path path = percent_decoded(uri);
    if (path.is_absolute()) {
        throw FormatError(what + ": " + uri + " is an absolute path; glTF wants a relative one");
    }
    const std::filesystem::path folder = std::filesystem::path(document.name).parent_path();
    auto file = std::make_shared<ooc::InputFile>(folder / path);
    document.n_bytes += file->size();
    const std::uint64_t size = file->size();
    return {std::move(file), 0, size};
}

/// Opens the buffers of a document.
class BufferFinder {
  public:
    BufferFinder(GltfDocument& document, std::shared_ptr<const ooc::InputFile> file,
                 const Chunks& chunks, const OpenOptions& options)
        : document_(document), file_(std::move(file)), chunks_(chunks), options_(options) {}

    void add(const gltf::Buffer& buffer) {
        const std::string what =
            document_.name + ": buffer " + std::to_string(document_.buffers.size());
        FileRange range = find(buffer, what);
        if (range.file && buffer.byte_length > range.n_bytes) {
            throw FormatError(what + " is truncated: it needs " +
                              std::to_string(buffer.byte_length) + " bytes, there are " +
                              std::to_string(range.n_bytes));
        }
        range.n_bytes = buffer.byte_length;
        document_.buffers.push_back(std::move(range));
    }

  private:
    FileRange find(const gltf::Buffer& buffer, const std::string& what) {
        if (buffer.uri) return find_uri(document_, *buffer.uri, what, options_);
        // The first buffer of a GLB is its chunk; others without an address are stand-ins.
        if (document_.buffers.empty() && chunks_.bin_bytes > 0) {
            return {file_, chunks_.bin_offset, chunks_.bin_bytes};
        }
        return {};
    }

    GltfDocument& document_;
    std::shared_ptr<const ooc::InputFile> file_;
    Chunks chunks_;
    OpenOptions options_;
};

}  // namespace

GltfDocument read_gltf(std::unique_ptr<ooc::InputFile> owned, bool is_binary,
                       const OpenOptions& options) {
    const std::shared_ptr<const ooc::InputFile> file = std::move(owned);
    GltfDocument document;
    document.name = file->path().string();
    document.n_bytes = file->size();
    document.held_temp_bytes = file->held_temp_bytes();
    document.is_binary = is_binary;
    const Chunks chunks = is_binary ? find_chunks(*file) : Chunks{0, file->size(), 0, 0, 0};
    document.trailing_bytes = chunks.trailing_bytes;
    ooc::MemoryBudget budget(options.memory_bytes != 0 ? options.memory_bytes
                                                       : ooc::default_memory_limit());
    const auto memory = budget.reserve("glTF document", kJsonMemory * chunks.json_bytes);
    std::string text(chunks.json_bytes, '\0');
    text.resize(file->read_at(chunks.json_offset, text.data(), text.size()));
    document.model = gltf::parse_model(parse(text, document.name), document.name);
    BufferFinder finder(document, file, chunks, options);
    for (gltf::Buffer& buffer : document.model.buffers) {
        finder.add(buffer);
        buffer.uri.reset();  // as long as its data, perhaps
    }
    return document;
}

FileRange open_image_data(GltfDocument& document, std::int64_t index, const OpenOptions& options) {
    const std::string what = document.name + ": image " + std::to_string(index);
    if (index < 0 || static_cast<std::size_t>(index) >= document.model.images.size()) {
        throw FormatError(what + " is asked for, but there is none");
    }
    const gltf::Image& image = document.model.images[static_cast<std::size_t>(index)];
    if (image.uri) return find_uri(document, *image.uri, what, options);
    FileRange range = buffer_view(document, image.view);
    if (!range.file) throw FormatError(what + ": the buffer of its data is not there");
    return range;
}

FileRange buffer_view(const GltfDocument& document, std::int64_t index) {
    const std::string what = document.name + ": buffer view " + std::to_string(index);
    if (index < 0 || static_cast<std::size_t>(index) >= document.model.views.size()) {
        throw FormatError(what + " is asked for, but there is none");
    }
    const gltf::BufferView& view = document.model.views[static_cast<std::size_t>(index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= document.buffers.size()) {
        throw FormatError(what + ": there is no buffer " + std::to_string(view.buffer));
    }
    const FileRange& buffer = document.buffers[static_cast<std::size_t>(view.buffer)];
    if (view.byte_offset > buffer.n_bytes || view.byte_length > buffer.n_bytes - view.byte_offset) {
        throw FormatError(what + " reaches beyond the " + std::to_string(buffer.n_bytes) +
                          " bytes of its buffer");
    }
    return {buffer.file, buffer.offset + view.byte_offset, view.byte_length};
}

}  // namespace hewer::streaming
