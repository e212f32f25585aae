// SPDX-License-Identifier: MIT
#include "tests/support/ply_builder.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>

namespace hewer::test {

namespace {

template <typename T>
std::string to_bytes(T value, bool is_big) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (is_big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

bool is_one_of(const std::string& type, std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), type) != names.end();
}

/// A property of an element: its declaration and its value in each row.
struct Column {
    std::string declaration;
    std::function<std::string(std::size_t)> value;
};

class Writer {
  public:
    explicit Writer(const PlyStyle& style) : style_(style) {
        line("ply");
        line("format " + style.format + " 1.0");
        if (style.has_comments) {
            line("comment made by a test");
            line("obj_info num_cols 512");
            line("comment");
        }
    }
    void element(const std::string& name, std::size_t count, const std::vector<Column>& columns) {
        line("element " + name + " " + std::to_string(count));
        for (const Column& column : columns) line("property " + column.declaration);
        for (std::size_t row = 0; row < count; ++row) {
            for (const Column& column : columns) body_ += column.value(row);
            if (style_.format == "ascii") body_ += style_.row_end;
        }
    }
    [[nodiscard]] std::string scalar(const std::string& type, double value) const {
        return ply_value(style_.format, type, value) +
               (style_.format == "ascii" ? style_.token_end : "");
    }
    template <typename T>
    std::string list(const std::string& count_type, const std::string& type,
                     const std::vector<T>& values) const {
        std::string text = scalar(count_type, static_cast<double>(values.size()));
        for (const T& value : values) text += scalar(type, static_cast<double>(value));
        return text;
    }
    std::string finish() {
        line("end_header");
        return header_ + body_;
    }

  private:
    void line(const std::string& text) { header_ += text + style_.line_end; }
    PlyStyle style_;
    std::string header_;
    std::string body_;
};

std::vector<Column> vertex_columns(const PlyMesh& mesh, const PlyStyle& style, const Writer& w) {
    std::vector<Column> columns;
    const auto add = [&](const std::string& type, const std::string& name,
                         const std::function<double(std::size_t)>& value) {
        columns.push_back({type + " " + name,
                           [&w, type, value](std::size_t i) { return w.scalar(type, value(i)); }});
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        add(style.coordinate_type, std::string(1, static_cast<char>('x' + axis)),
            [&mesh, axis](std::size_t i) { return mesh.positions[i][axis]; });
    }
    for (std::size_t axis = 0; axis < 3 && !mesh.normals.empty(); ++axis) {
        add(style.normal_type, std::string("n") + static_cast<char>('x' + axis),
            [&mesh, axis](std::size_t i) { return mesh.normals[i][axis]; });
    }
    for (std::size_t c = 0; c < (style.has_alpha ? 4U : 3U) && !mesh.colors.empty(); ++c) {
        add(style.color_type, style.color_names[c],
            [&mesh, c](std::size_t i) { return mesh.colors[i][c]; });
    }
    if (style.has_extra_scalars) {
        add("float", "confidence", [](std::size_t i) { return static_cast<double>(i) * 0.5; });
        add("ushort", "flags", [](std::size_t i) { return static_cast<double>(i % 60000); });
    }
    if (style.has_extra_lists) {
        columns.push_back({"list ushort double views", [&w](std::size_t i) {
                               return w.list("ushort", "double", std::vector<double>(i % 4, 0.25));
                           }});
    }
    std::mt19937 random(style.column_order);
    if (style.column_order != 0) std::shuffle(columns.begin(), columns.end(), random);
    return columns;
}

std::vector<Column> face_columns(const PlyMesh& mesh, const PlyStyle& style, const Writer& w) {
    std::vector<Column> columns;
    if (style.has_extra_scalars) {
        columns.push_back({"short group", [&w](std::size_t) { return w.scalar("short", -3); }});
    }
    if (style.has_extra_lists) {
        columns.push_back({"list uchar float texcoord", [&w](std::size_t i) {
                               return w.list("uchar", "float", std::vector<double>(i % 3, 0.5));
                           }});
    }
    columns.push_back({"list " + style.count_type + " " + style.index_type + " " + style.index_name,
                       [&mesh, &style, &w](std::size_t i) {
                           return w.list(style.count_type, style.index_type, mesh.faces[i]);
                       }});
    if (style.has_extra_lists) {
        columns.push_back({"list int int neighbours", [&w](std::size_t i) {
                               return w.list("int", "int", std::vector<int>(i % 2, 7));
                           }});
    }
    if (style.has_extra_scalars) {
        columns.push_back({"double quality", [&w](std::size_t) { return w.scalar("double", 1); }});
    }
    return columns;
}

}  // namespace

std::string ply_value(const std::string& format, const std::string& type, double value) {
    if (format == "ascii") {
        std::ostringstream text;
        text.precision(std::numeric_limits<double>::max_digits10);
        text << value;
        return text.str();
    }
    const bool is_big = format == "binary_big_endian";
    if (is_one_of(type, {"float", "float32"})) return to_bytes(static_cast<float>(value), is_big);
    if (is_one_of(type, {"double", "float64"})) return to_bytes(value, is_big);
    const std::int64_t whole = static_cast<std::int64_t>(value);
    if (is_one_of(type, {"char", "int8", "uchar", "uint8"})) {
        return to_bytes(static_cast<std::uint8_t>(whole), is_big);
    }
    if (is_one_of(type, {"short", "int16", "ushort", "uint16"})) {
        return to_bytes(static_cast<std::uint16_t>(whole), is_big);
    }
    if (is_one_of(type, {"int", "int32", "uint", "uint32"})) {
        return to_bytes(static_cast<std::uint32_t>(whole), is_big);
    }
    if (is_one_of(type, {"int64", "uint64", "long", "longlong", "ulong", "ulonglong"})) {
        return to_bytes(static_cast<std::uint64_t>(whole), is_big);
    }
    throw std::invalid_argument(type);
}

std::string ply_file(const PlyMesh& mesh, const PlyStyle& style) {
    Writer w(style);
    const auto extra = [&](const std::string& name, std::size_t count) {
        if (!style.has_extra_elements) return;
        w.element(name, count,
                  {{"double value", [&w](std::size_t) { return w.scalar("double", 1.5); }},
                   {"list uchar short items", [&w](std::size_t i) {
                        return w.list("uchar", "short", std::vector<int>(i + 1, -1));
                    }}});
    };
    const auto vertices = [&] {
        w.element("vertex", mesh.positions.size(), vertex_columns(mesh, style, w));
    };
    const auto faces = [&] {
        w.element(style.has_strips ? "tristrips" : "face", mesh.faces.size(),
                  face_columns(mesh, style, w));
    };
    extra("camera", 1);
    style.faces_first ? faces() : vertices();
    extra("material", 3);
    style.faces_first ? vertices() : faces();
    extra("edge_loop", 5);
    return w.finish();
}

std::string stl_file(const std::vector<std::array<std::array<double, 3>, 3>>& triangles,
                     std::uint32_t announced, const std::string& comment) {
    std::string text = comment;
    text.resize(80);
    text += to_bytes(announced, false);
    for (const auto& triangle : triangles) {
        text += std::string(12, '\0');
        for (const auto& point : triangle) {
            for (const double x : point) text += to_bytes(static_cast<float>(x), false);
        }
        text += std::string(2, '\0');
    }
    return text;
}

}  // namespace hewer::test
