// SPDX-License-Identifier: MIT
/// GLB files of any layout as strings, written independently of the library.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hewer::test {

/// Collects arrays into the binary chunk, with a buffer view and an accessor for each.
class GlbBuilder {
  public:
    using Json = nlohmann::json;

    /// The document; asset, buffers, bufferViews and accessors come by themselves.
    Json document = {{"asset", {{"version", "2.0"}}}};

    /// Bytes at the next multiple of four. Returns the buffer view.
    std::size_t add_view(const std::string& bytes, std::uint64_t stride = 0) {
        binary_.resize((binary_.size() + 3) / 4 * 4);
        Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
        if (stride != 0) view["byteStride"] = stride;
        binary_ += bytes;
        document["bufferViews"].push_back(view);
        return document["bufferViews"].size() - 1;
    }
    /// @param component  5120 int8, 5121 uint8, 5122 int16, 5123 uint16, 5125 uint32, 5126 float
    std::size_t add_accessor(std::size_t view, std::uint64_t count, int component,
                             const std::string& type, const Json& more = Json::object()) {
        Json accessor = {
            {"bufferView", view}, {"count", count}, {"componentType", component}, {"type", type}};
        accessor.update(more);
        document["accessors"].push_back(accessor);
        return document["accessors"].size() - 1;
    }
    template <typename T>
    std::size_t add_array(const std::vector<T>& values, std::size_t n_components, int component,
                          const Json& more = Json::object()) {
        static const char* const kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        return add_accessor(add_view(bytes_of(values)), values.size() / n_components, component,
                            kTypes[n_components], more);
    }
    template <typename T>
    static std::string bytes_of(const std::vector<T>& values) {
        std::string bytes(values.size() * sizeof(T), '\0');
        if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
        return bytes;
    }

    [[nodiscard]] const std::string& binary() const { return binary_; }
    [[nodiscard]] std::string glb() const {
        Json all = document;
        all["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
        return glb_of(all.dump(), binary_);
    }
    static std::string glb_of(std::string json, std::string binary) {
        json.resize((json.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4);
        std::string file = "glTF";
        put(file, 2);
        put(file, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
        put(file, static_cast<std::uint32_t>(json.size()));
        file += "JSON" + json;
        put(file, static_cast<std::uint32_t>(binary.size()));
        file += std::string("BIN\0", 4) + binary;
        return file;
    }

  private:
    static void put(std::string& file, std::uint32_t word) {
        for (unsigned b = 0; b < 4; ++b) file += static_cast<char>(word >> (8 * b));
    }
    std::string binary_;
};

}  // namespace hewer::test
