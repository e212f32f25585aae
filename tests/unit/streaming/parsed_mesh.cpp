// SPDX-License-Identifier: MIT
#include "tests/unit/streaming/parsed_mesh.h"

#include <tiny_gltf.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hewer::tests {

namespace {

void require(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error(what);
}

/// Unlike std::stod, takes numbers below the normal range of a double.
double number(const std::string& text) {
    char* end = nullptr;
    const double x = std::strtod(text.c_str(), &end);
    require(!text.empty() && *end == '\0', "not a number: " + text);
    return x;
}

/// Takes numbers from a string of bytes, front to back.
class Bytes {
  public:
    Bytes(const std::string& bytes, std::size_t at) : bytes_(bytes), at_(at) {}
    template <typename T>
    T take() {
        require(bytes_.size() - at_ >= sizeof(T), "truncated");
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    void end() const { require(at_ == bytes_.size(), "bytes after the end"); }

  private:
    const std::string& bytes_;
    std::size_t at_;
};

}  // namespace

std::string read_whole(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    require(in.good(), "cannot open " + path.string());
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

ParsedMesh parse_ply(const std::filesystem::path& path) {
    const std::string bytes = read_whole(path);
    const std::size_t end = bytes.find("end_header\n");
    require(end != std::string::npos, "no end_header");
    ParsedMesh mesh;
    std::istringstream text(bytes.substr(0, end));
    std::size_t n_vertices = 0, n_faces = 0;
    bool is_vertex = false;
    std::vector<std::string> types, names;
    std::string list;
    for (std::string line; std::getline(text, line);) {
        mesh.header.push_back(line);
        std::istringstream words(line);
        std::string word, a, b;
        words >> word >> a >> b;
        if (word == "element") {
            is_vertex = a == "vertex";
            (is_vertex ? n_vertices : n_faces) = std::stoull(b);
        } else if (word == "property" && is_vertex) {
            types.push_back(a);
            names.push_back(b);
        } else if (word == "property") {
            list = line;
        }
    }
    require(mesh.header.at(0) == "ply" && mesh.header.at(1) == "format binary_little_endian 1.0",
            "not a binary PLY");
    require(list == "property list uchar int vertex_indices", "unexpected list: " + list);
    Bytes in(bytes, end + std::strlen("end_header\n"));
    for (std::size_t i = 0; i < n_vertices; ++i) {
        std::vector<double> v;
        for (const std::string& type : types) {
            if (type == "double") {
                v.push_back(in.take<double>());
            } else if (type == "float") {
                v.push_back(static_cast<double>(in.take<float>()));
            } else {
                require(type == "uchar", "unexpected type " + type);
                v.push_back(static_cast<double>(in.take<std::uint8_t>()));
            }
        }
        mesh.positions.push_back({v.at(0), v.at(1), v.at(2)});
        std::size_t at = 3;
        if (names.size() > at && names[at] == "nx") {
            mesh.normals.push_back({v.at(3), v.at(4), v.at(5)});
            at = 6;
        }
        if (names.size() > at) {
            require(names[at] == "red" && names.at(at + 2) == "blue", "unexpected properties");
            mesh.colors.push_back(
                {v.at(at), v.at(at + 1), v.at(at + 2), names.size() > at + 3 ? v.at(at + 3) : -1});
        }
    }
    for (std::size_t i = 0; i < n_faces; ++i) {
        require(in.take<std::uint8_t>() == 3, "not a triangle");
        std::array<std::uint64_t, 3> t{};
        for (auto& id : t) id = static_cast<std::uint64_t>(in.take<std::int32_t>());
        mesh.triangles.push_back(t);
    }
    in.end();
    return mesh;
}

ParsedMesh parse_obj(const std::filesystem::path& path) {
    std::istringstream text(read_whole(path));
    ParsedMesh mesh;
    for (std::string line; std::getline(text, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        std::vector<std::string> rest;
        for (std::string w; words >> w;) rest.push_back(w);
        if (word == "v") {
            require(rest.size() == 3 || rest.size() == 6, "odd vertex: " + line);
            mesh.positions.push_back({number(rest[0]), number(rest[1]), number(rest[2])});
            if (rest.size() == 6) {
                mesh.colors.push_back({number(rest[3]), number(rest[4]), number(rest[5]), -1});
            }
        } else if (word == "vn") {
            require(rest.size() == 3, "odd normal: " + line);
            mesh.normals.push_back({number(rest[0]), number(rest[1]), number(rest[2])});
        } else if (word == "f") {
            require(rest.size() == 3, "odd face: " + line);
            std::array<std::uint64_t, 3> t{};
            for (std::size_t i = 0; i < 3; ++i) {
                t[i] = std::stoull(rest[i]) - 1;
                const std::string id = std::to_string(t[i] + 1);
                require(rest[i] == (mesh.normals.empty() ? id : id + "//" + id),
                        "odd corner: " + line);
            }
            mesh.triangles.push_back(t);
        } else {
            require(word == "#", "odd line: " + line);
        }
    }
    return mesh;
}

ParsedMesh parse_stl(const std::filesystem::path& path) {
    const std::string bytes = read_whole(path);
    require(bytes.size() >= 84 && bytes.compare(0, 5, "solid") != 0, "not a binary STL");
    Bytes in(bytes, 80);
    const auto n = in.take<std::uint32_t>();
    ParsedMesh mesh;
    const auto point = [&] {
        std::array<double, 3> p{};
        for (double& x : p) x = static_cast<double>(in.take<float>());
        return p;
    };
    for (std::uint64_t i = 0; i < n; ++i) {
        mesh.normals.push_back(point());
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(point());
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        require(in.take<std::uint16_t>() == 0, "attribute bytes are set");
    }
    in.end();
    return mesh;
}

ParsedMesh parse_glb(const std::filesystem::path& path) {
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    require(loader.LoadBinaryFromFile(&model, &error, &warning, path.string()), error);
    require(error.empty() && warning.empty(), error + warning);
    require(model.meshes.size() == 1 && model.meshes[0].primitives.size() == 1 &&
                model.nodes.size() == 1 && model.scenes.size() == 1 && model.buffers.size() == 1,
            "not one mesh");
    ParsedMesh mesh;
    const tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
    const auto at = [&](const tinygltf::Accessor& a, std::size_t i) {
        const tinygltf::BufferView& view =
            model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
        const std::size_t stride = static_cast<std::size_t>(a.ByteStride(view));
        const std::size_t offset = view.byteOffset + a.byteOffset + i * stride;
        require(offset + 1 <= model.buffers[0].data.size(), "accessor leaves the buffer");
        return model.buffers[0].data.data() + offset;
    };
    const auto vectors = [&](const std::string& name) {
        std::vector<std::array<double, 3>> result;
        const auto it = primitive.attributes.find(name);
        if (it == primitive.attributes.end()) return result;
        const tinygltf::Accessor& a = model.accessors.at(static_cast<std::size_t>(it->second));
        require(a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT && a.type == TINYGLTF_TYPE_VEC3,
                name + " is not three floats");
        for (std::size_t i = 0; i < a.count; ++i) {
            std::array<float, 3> v{};
            std::memcpy(v.data(), at(a, i), sizeof v);
            result.push_back(
                {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])});
        }
        return result;
    };
    mesh.positions = vectors("POSITION");
    mesh.normals = vectors("NORMAL");
    const tinygltf::Accessor& positions =
        model.accessors.at(static_cast<std::size_t>(primitive.attributes.at("POSITION")));
    for (std::size_t i = 0; i < 3; ++i) {
        mesh.min[i] = positions.minValues.at(i);
        mesh.max[i] = positions.maxValues.at(i);
    }
    if (const auto it = primitive.attributes.find("COLOR_0"); it != primitive.attributes.end()) {
        const tinygltf::Accessor& a = model.accessors.at(static_cast<std::size_t>(it->second));
        require(a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                    a.type == TINYGLTF_TYPE_VEC4 && a.normalized,
                "COLOR_0 is not four normalised ushorts");
        for (std::size_t i = 0; i < a.count; ++i) {
            std::array<std::uint16_t, 4> c{};
            std::memcpy(c.data(), at(a, i), sizeof c);
            mesh.colors.push_back({double(c[0]), double(c[1]), double(c[2]), double(c[3])});
        }
    }
    const tinygltf::Accessor& indices =
        model.accessors.at(static_cast<std::size_t>(primitive.indices));
    mesh.has_short_indices = indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    for (std::size_t i = 0; i < indices.count; ++i) {
        if (i % 3 == 0) mesh.triangles.emplace_back();
        std::uint32_t id = 0;
        std::memcpy(&id, at(indices, i), mesh.has_short_indices ? 2 : 4);
        mesh.triangles.back()[i % 3] = id;
    }
    if (!model.nodes[0].translation.empty()) {
        for (std::size_t i = 0; i < 3; ++i) mesh.translation[i] = model.nodes[0].translation.at(i);
    }
    mesh.alpha_mode = model.materials.at(0).alphaMode;
    mesh.generator = model.asset.generator;
    return mesh;
}

}  // namespace hewer::tests
