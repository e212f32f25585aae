// SPDX-License-Identifier: MIT
#include "streaming/mtl_reader.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "hewer/error.h"
#include "ooc/file.h"
#include "streaming/number_parser.h"

namespace hewer::streaming {

namespace {

/// A line, word by word.
class Words {
  public:
    explicit Words(std::string_view line) : left_(trimmed(line)) {}

    [[nodiscard]] std::string_view rest() const { return left_; }
    /// Empty at the end of the line.
    [[nodiscard]] std::string_view peek() const {
        const auto end = std::find_if(left_.begin(), left_.end(), is_space);
        return left_.substr(0, static_cast<std::size_t>(end - left_.begin()));
    }
    std::string_view next() {
        const std::string_view word = peek();
        left_ = trimmed(left_.substr(word.size()));
        return word;
    }
    std::optional<double> next_number() {
        const std::string word(peek());
        const auto* const p = reinterpret_cast<const unsigned char*>(word.c_str());
        double value = 0;
        if (word.empty() || parse_double(p, value) != p + word.size()) return {};
        next();
        return value;
    }

  private:
    static bool is_space(char c) { return is_blank(static_cast<unsigned char>(c)); }
    static std::string_view trimmed(std::string_view text) {
        while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
        while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
        return text;
    }
    std::string_view left_;
};

std::string lower(std::string_view word) {
    std::string result(word);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

void read_color(Words& words, MtlMaterial& material) {
    const std::optional<double> red = words.next_number();
    if (!red) return;  // "spectral FILE", "xyz X Y Z"
    const double green = words.next_number().value_or(*red);
    const double blue = words.next_number().value_or(*red);
    MeanColor color;
    std::size_t k = 0;
    // The condition is false for NaN, too.
    for (const double x : {*red, green, blue}) {
        color[k++] = x > 0 ? static_cast<float>(std::min(x, 1.0)) : 0;
    }
    material.color = color;
}

/// One or two numbers; a third is of textures in space.
void read_pair(Words& words, std::array<double, 2>& pair) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<double> x = words.next_number();
        if (!x) return;
        if (k < 2) pair[k] = *x;
    }
}

/// Options, each with its arguments, then the name of the file, which may have blanks in it.
void read_map(Words& words, const std::filesystem::path& folder, MtlMaterial& material) {
    while (words.peek().starts_with('-')) {
        const std::string option = lower(words.next());
        if (option == "-s") {
            read_pair(words, material.scale);
        } else if (option == "-o") {
            read_pair(words, material.offset);
        } else if (option == "-clamp") {
            material.is_clamped = lower(words.next()) == "on";
        } else if (option == "-t" || option == "-mm" || option == "-bm" || option == "-boost" ||
                   option == "-texres") {
            while (words.next_number()) {
            }
        } else {
            words.next();  // -blendu on, -blendv on, -cc on, -imfchan r, -type sphere
        }
    }
    if (!words.rest().empty()) material.map = find_beside(folder, std::string(words.rest()));
}

bool is_other_map(const std::string& statement) {
    return (statement.starts_with("map_") && statement != "map_aat") || statement == "bump" ||
           statement == "disp" || statement == "decal" || statement == "refl" ||
           statement == "norm";
}

}  // namespace

std::filesystem::path find_beside(const std::filesystem::path& folder, std::string name) {
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') {
        name = name.substr(1, name.size() - 2);
    }
    std::replace(name.begin(), name.end(), '\\', '/');
    const bool has_drive = name.size() > 1 && name[1] == ':';
    const std::filesystem::path path = name;
    if (has_drive || path.is_absolute()) return (folder / path.filename()).lexically_normal();
    return (folder / path).lexically_normal();
}

void read_mtl(ooc::Context& context, const std::filesystem::path& path, MtlLibrary& library) {
    const ooc::InputFile file(path);
    if (file.size() > kMostMtlBytes) {
        throw FormatError(path.string() + ": " + std::to_string(file.size()) +
                          " bytes are too many for a material library");
    }
    const ooc::Reservation memory = context.budget().reserve("material library", 4 * file.size());
    std::string text(file.size(), '\0');
    text.resize(file.read_at(0, text.data(), text.size()));
    MtlMaterial* material = nullptr;  // none: before the first, or defined twice
    for (std::string_view left = text; !left.empty();) {
        const std::size_t end = std::min(left.find_first_of("\r\n"), left.size());
        Words words(left.substr(0, end));
        left.remove_prefix(std::min(end + 1, left.size()));
        const std::string statement = lower(words.next());
        if (statement == "newmtl") {
            const auto [it, is_new] = library.try_emplace(std::string(words.rest()));
            material = is_new ? &it->second : nullptr;
        } else if (material == nullptr) {
            continue;
        } else if (statement == "kd") {
            read_color(words, *material);
        } else if (statement == "map_kd") {
            read_map(words, path.parent_path(), *material);
        } else if (is_other_map(statement) && material->other_map.empty()) {
            material->other_map = statement;
        }
    }
}

}  // namespace hewer::streaming
