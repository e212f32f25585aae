// SPDX-License-Identifier: MIT
#include "tests/bench/plain_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numeric>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace bench {
namespace {

static_assert(std::endian::native == std::endian::little, "binary values are copied as they are");

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Fewest bytes of a face record: its count and three ids.
constexpr std::size_t kTriangleRecordBytes = 13;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
    throw std::runtime_error(path + ": " + what);
}

File open_file(const std::string& path, const char* mode) {
    File file(std::fopen(path.c_str(), mode), &std::fclose);
    if (!file) fail(path, "cannot be opened");
    return file;
}

std::size_t bytes_of_type(const std::string& path, const std::string& type) {
    for (const char* name : {"char", "uchar", "int8", "uint8"}) {
        if (type == name) return 1;
    }
    for (const char* name : {"short", "ushort", "int16", "uint16"}) {
        if (type == name) return 2;
    }
    for (const char* name : {"int", "uint", "float", "int32", "uint32", "float32"}) {
        if (type == name) return 4;
    }
    if (type == "double" || type == "float64") return 8;
    fail(path, "unknown type " + type);
}

struct Header {
    bool is_ascii = false;
    std::size_t n_vertices = 0;
    std::size_t n_faces = 0;
    std::size_t vertex_bytes = 0;
    std::size_t vertex_properties = 0;
    std::array<std::size_t, 3> xyz_offset{};  ///< in bytes
    std::array<std::size_t, 3> xyz_column{};  ///< in properties
    std::size_t n_coordinates = 0;
    bool is_double = false;  ///< of the coordinates
};

void parse_vertex_property(const std::string& path, std::istringstream& line, Header& header) {
    std::string type;
    std::string name;
    line >> type >> name;
    const std::size_t bytes = bytes_of_type(path, type);
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
        header.is_double = type == "double" || type == "float64";
        if (!header.is_double && type != "float" && type != "float32") {
            fail(path, "coordinates are not float or double");
        }
        const auto axis = static_cast<std::size_t>(name[0] - 'x');
        header.xyz_offset[axis] = header.vertex_bytes;
        header.xyz_column[axis] = header.vertex_properties;
        ++header.n_coordinates;
    }
    header.vertex_bytes += bytes;
    ++header.vertex_properties;
}

void check_face_property(const std::string& path, std::istringstream& line) {
    std::string list;
    std::string count_type;
    std::string id_type;
    line >> list >> count_type >> id_type;
    const bool is_plain =
        list == "list" && bytes_of_type(path, count_type) == 1 && bytes_of_type(path, id_type) == 4;
    if (!is_plain) fail(path, "faces are not a single list of uchar count and int ids");
}

Header read_header(const std::string& path, std::FILE* file) {
    Header header;
    std::string element;
    std::array<char, 4096> text{};
    while (std::fgets(text.data(), static_cast<int>(text.size()), file)) {
        std::istringstream line(text.data());
        std::string word;
        line >> word;
        if (word == "format") {
            line >> word;
            header.is_ascii = word == "ascii";
            if (!header.is_ascii && word != "binary_little_endian") fail(path, "is " + word);
        } else if (word == "element") {
            line >> element;
            if (element == "vertex") line >> header.n_vertices;
            if (element == "face") line >> header.n_faces;
        } else if (word == "property" && element == "vertex") {
            parse_vertex_property(path, line, header);
        } else if (word == "property" && element == "face") {
            check_face_property(path, line);
        } else if (word == "end_header") {
            if (header.n_coordinates != 3) fail(path, "has no x, y, z");
            if (header.n_faces == 0) fail(path, "has no faces");
            return header;
        }
    }
    fail(path, "has no end of header");
}

std::size_t remaining_bytes(std::FILE* file) {
    const off_t here = ftello(file);
    fseeko(file, 0, SEEK_END);
    const off_t end = ftello(file);
    fseeko(file, here, SEEK_SET);
    return static_cast<std::size_t>(end - here);
}

void fan(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices) {
    for (std::size_t corner = 2; corner < polygon.size(); ++corner) {
        indices.insert(indices.end(), {polygon[0], polygon[corner - 1], polygon[corner]});
    }
}

void read_binary_vertices(const std::string& path, std::FILE* file, const Header& header,
                          std::vector<float>& positions) {
    positions.resize(3 * header.n_vertices);
    const bool is_packed = !header.is_double && header.vertex_bytes == 12 &&
                           header.xyz_offset[0] == 0 && header.xyz_offset[1] == 4 &&
                           header.xyz_offset[2] == 8;
    if (is_packed) {
        if (std::fread(positions.data(), 12, header.n_vertices, file) != header.n_vertices) {
            fail(path, "is truncated");
        }
        return;
    }
    const std::size_t n_bytes = header.n_vertices * header.vertex_bytes;
    const auto block = std::make_unique_for_overwrite<char[]>(n_bytes);
    if (std::fread(block.get(), 1, n_bytes, file) != n_bytes) fail(path, "is truncated");
    for (std::size_t v = 0; v < header.n_vertices; ++v) {
        const char* record = block.get() + v * header.vertex_bytes;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const char* value = record + header.xyz_offset[axis];
            if (header.is_double) {
                double wide = 0;
                std::memcpy(&wide, value, sizeof wide);
                positions[3 * v + axis] = static_cast<float>(wide);
            } else {
                std::memcpy(&positions[3 * v + axis], value, sizeof(float));
            }
        }
    }
}

void read_binary_faces(const std::string& path, std::FILE* file, const Header& header,
                       std::vector<std::uint32_t>& indices) {
    const std::size_t n_bytes = remaining_bytes(file);
    const auto block = std::make_unique_for_overwrite<char[]>(n_bytes);
    if (std::fread(block.get(), 1, n_bytes, file) != n_bytes) fail(path, "is truncated");
    if (header.n_faces > n_bytes / kTriangleRecordBytes) fail(path, "is truncated");
    indices.resize(3 * header.n_faces);
    const char* record = block.get();
    const char* const end = record + n_bytes;
    std::size_t face = 0;
    for (; face < header.n_faces && end - record >= 13 && *record == 3; ++face, record += 13) {
        std::memcpy(&indices[3 * face], record + 1, 12);
    }
    // The first polygon ends the fast path; most files never meet one.
    indices.resize(3 * face);
    std::array<std::uint32_t, 255> polygon{};
    for (; face < header.n_faces; ++face) {
        if (record == end) fail(path, "is truncated");
        const auto n_corners = static_cast<std::size_t>(static_cast<unsigned char>(*record));
        if (static_cast<std::size_t>(end - record) < 1 + 4 * n_corners) fail(path, "is truncated");
        std::memcpy(polygon.data(), record + 1, 4 * n_corners);
        fan({polygon.data(), n_corners}, indices);
        record += 1 + 4 * n_corners;
    }
}

/// Numbers parted by white space, from a text that is in memory whole.
class Numbers {
  public:
    Numbers(const std::string& path, const char* begin, const char* end)
        : path_(path), at_(begin), end_(end) {}

    template <typename T>
    T next() {
        while (at_ != end_ && static_cast<unsigned char>(*at_) <= ' ') ++at_;
        T value{};
        const std::from_chars_result result = std::from_chars(at_, end_, value);
        if (result.ec != std::errc{}) fail(path_, "has a bad number or is truncated");
        at_ = result.ptr;
        return value;
    }

  private:
    const std::string& path_;
    const char* at_;
    const char* end_;
};

void read_ascii(const std::string& path, std::FILE* file, const Header& header, PlainMesh& mesh) {
    const std::size_t n_bytes = remaining_bytes(file);
    const auto text = std::make_unique_for_overwrite<char[]>(n_bytes);
    if (std::fread(text.get(), 1, n_bytes, file) != n_bytes) fail(path, "cannot be read");
    Numbers numbers(path, text.get(), text.get() + n_bytes);

    mesh.positions.resize(3 * header.n_vertices);
    std::vector<float> row(header.vertex_properties);
    for (std::size_t v = 0; v < header.n_vertices; ++v) {
        for (float& value : row) value = numbers.next<float>();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            mesh.positions[3 * v + axis] = row[header.xyz_column[axis]];
        }
    }
    mesh.indices.reserve(3 * header.n_faces);
    std::array<std::uint32_t, 255> polygon{};
    for (std::size_t face = 0; face < header.n_faces; ++face) {
        const auto n_corners = numbers.next<std::uint8_t>();
        for (std::size_t corner = 0; corner < n_corners; ++corner) {
            polygon[corner] = numbers.next<std::uint32_t>();
        }
        fan({polygon.data(), n_corners}, mesh.indices);
    }
}

}  // namespace

PlainMesh read_plain_ply(const std::string& path) {
    const File file = open_file(path, "rb");
    const Header header = read_header(path, file.get());
    PlainMesh mesh;
    if (header.is_ascii) {
        read_ascii(path, file.get(), header, mesh);
    } else {
        read_binary_vertices(path, file.get(), header, mesh.positions);
        read_binary_faces(path, file.get(), header, mesh.indices);
    }
    for (const std::uint32_t id : mesh.indices) {
        if (id >= header.n_vertices) fail(path, "has a vertex id out of range");
    }
    return mesh;
}

void write_plain_ply(const std::string& path, const PlainMesh& mesh) {
    const File file = open_file(path, "wb");
    const std::size_t n_triangles = mesh.indices.size() / 3;
    std::fprintf(file.get(),
                 "ply\nformat binary_little_endian 1.0\n"
                 "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
                 mesh.positions.size() / 3, n_triangles);
    std::fwrite(mesh.positions.data(), sizeof(float), mesh.positions.size(), file.get());
    std::vector<char> records(n_triangles * kTriangleRecordBytes);
    for (std::size_t t = 0; t < n_triangles; ++t) {
        char* record = records.data() + t * kTriangleRecordBytes;
        *record = 3;
        std::memcpy(record + 1, &mesh.indices[3 * t], 12);
    }
    std::fwrite(records.data(), 1, records.size(), file.get());
    if (std::fflush(file.get()) != 0 || std::ferror(file.get())) fail(path, "cannot be written");
}

std::vector<std::uint32_t> first_at_position(const PlainMesh& mesh) {
    const auto position = [&](std::uint32_t v) {
        const float* p = &mesh.positions[std::size_t{3} * v];
        return std::array<float, 3>{p[0], p[1], p[2]};
    };
    std::vector<std::uint32_t> order(mesh.positions.size() / 3);
    std::iota(order.begin(), order.end(), std::uint32_t{0});
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(position(a), a) < std::pair(position(b), b);
    });
    std::vector<std::uint32_t> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool is_repeat = i > 0 && position(order[i]) == position(order[i - 1]);
        first[order[i]] = is_repeat ? first[order[i - 1]] : order[i];
    }
    return first;
}

}  // namespace bench
