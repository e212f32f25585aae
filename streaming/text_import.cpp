// SPDX-License-Identifier: MIT
#include "streaming/text_import.h"

#include <array>

#include "ooc/units.h"

namespace hewer::streaming {

namespace {
std::string name(const char* element, const TextPlace& place, std::uint64_t n_before,
                 std::uint64_t first_line) {
    return std::string(element) + " " + std::to_string(n_before + place.number) + " (line " +
           std::to_string(first_line + place.line) + ")";
}
}  // namespace

void TextFindings::note(const TextDirt& dirt, std::uint64_t n_elements_before,
                        std::uint64_t n_faces_before, std::uint64_t first_line) {
    struct Finding {
        const std::optional<TextPlace>& place;
        const char* element;
        std::uint64_t n_before;
        std::string what;
        std::string* first;
    };
    InputDefects& defects = import_.defects();
    std::array<Finding, 3> findings{
        {{dirt.nonfinite, element_, n_elements_before, "a coordinate is not finite",
          &defects.first_nonfinite},
         {dirt.out_of_range, "face", n_faces_before,
          "a vertex id outside the " + std::to_string(import_.n_vertices()) + " vertices",
          &defects.first_out_of_range},
         {dirt.short_face, "face", n_faces_before, "fewer than three corners", nullptr}}};
    const Finding* refused = nullptr;
    for (const Finding& finding : findings) {
        if (!finding.place) continue;
        if (refused == nullptr || finding.place->line < refused->place->line) refused = &finding;
        if (finding.first != nullptr && finding.first->empty()) {
            *finding.first = name(finding.element, *finding.place, finding.n_before, first_line);
        }
    }
    if (refused == nullptr || !import_.is_strict()) return;
    throw FormatError(path_ + ": " +
                      name(refused->element, *refused->place, refused->n_before, first_line) +
                      ": " + refused->what + "; strict mode refuses it");
}

TextProblem TextImport::too_long(const TextChunk& chunk) {
    return {chunk.end(), "a line or facet of more than " +
                             ooc::format_bytes(TextChunks::kMaxLineBytes) +
                             " is beyond what hewer reads"};
}

void TextImport::fail(std::uint64_t line, const std::string& what) const {
    throw FormatError(chunks_.file().path().string() + ": line " + std::to_string(line) + ": " +
                      what);
}

}  // namespace hewer::streaming
