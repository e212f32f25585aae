// SPDX-License-Identifier: MIT
/// How the readers of text formats work: chunks are parsed on all threads, and what was found goes
/// into a MeshImport in the order of the file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "hewer/error.h"
#include "ooc/parallel.h"
#include "streaming/block_pool.h"
#include "streaming/mesh_import.h"
#include "streaming/text_chunks.h"

namespace hewer::streaming {

/// What changes the speed of reading text, never the result. For tests.
struct TextTuning {
    std::uint64_t chunk_bytes = 0;  ///< 0: by the memory limit
};

/// An element of the file and the line that it begins in. Lines count from 1, elements from 0.
struct TextPlace {
    std::uint64_t number = 0;
    std::uint64_t line = 0;
};

/// The first of each kind of dirt in a chunk. Vertices, faces and lines count from its beginning.
struct TextDirt {
    std::optional<TextPlace> nonfinite;
    std::optional<TextPlace> short_face;
    std::optional<TextPlace> out_of_range;
};

/// Notes the first of each kind of dirt in import.defects(), "vertex 17 (line 1234)", or, if the
/// import is strict, throws the first of all as FormatError. The reader counts.
class TextFindings {
  public:
    /// @param element  what a coordinate belongs to: "vertex", or "triangle" of a soup.
    TextFindings(MeshImport& import, std::string path, const char* element)
        : import_(import), path_(std::move(path)), element_(element) {}

    /// Of a chunk with that many elements and faces before it.
    void note(const TextDirt& dirt, std::uint64_t n_elements_before, std::uint64_t n_faces_before,
              std::uint64_t first_line);

  private:
    MeshImport& import_;
    std::string path_;
    const char* element_;
};

/// Chunks of a file for an import, with the memory for those that are in flight.
class TextImport {
  public:
    TextImport(const ooc::InputFile& file, MeshImport& import, FindCut find_cut,
               const TextTuning& tuning)
        : import_(import),
          chunks_(file, import.context().budget(),
                  TextChunks::choose_chunk_bytes(tuning.chunk_bytes, import.context().budget(),
                                                 n_in_flight()),
                  find_cut),
          memory_(import.context().budget().reserve("text that is being parsed",
                                                    n_in_flight() * chunks_.held_bytes())) {}

    [[nodiscard]] const TextChunks& chunks() const { return chunks_; }

    /// parse(chunk, parsed) on all threads, then deliver(parsed, first_line, chunk_number) one
    /// after the other, in order, until it returns false: nothing more is wanted. `parsed` is used
    /// again and again: parse() clears it. A TextProblem that parse() throws ends the import, after
    /// what was parsed in front of it is delivered.
    /// @param first_line  of the first chunk.
    template <typename Parsed, typename Parse, typename Deliver>
    void run(const TextChunks& chunks, std::uint64_t first_line, const Parse& parse,
             const Deliver& deliver) const {
        struct Work {
            TextChunk chunk;
            Parsed parsed;
            std::optional<std::string> problem;
            std::uint64_t problem_line = 0;
        };
        BlockPool<Work> pool;
        std::uint64_t line = first_line;
        bool is_wanted = true;
        import_.context().workers().in_order(
            chunks.size(), n_in_flight(),
            [&](std::uint64_t i) {
                auto work = pool.lease();
                work->problem.reset();
                chunks.read(i, work->chunk);
                try {
                    if (work->chunk.is_too_long) throw too_long(work->chunk);
                    parse(work->chunk, work->parsed);
                } catch (const TextProblem& problem) {
                    work->problem = problem.what;
                    work->problem_line = work->chunk.lines_before(problem.at);
                }
                return work;
            },
            [&](std::uint64_t i, typename BlockPool<Work>::Lease& work) {
                if (!is_wanted) return;
                is_wanted = work->chunk.is_too_long || deliver(work->parsed, line, i);
                if (is_wanted && work->problem) fail(line + work->problem_line, *work->problem);
                line += work->chunk.n_lines;
                import_.context().advance(work->chunk.n_bytes);
                // What has grown beyond the usual size is not kept for the next chunk.
                if (work->chunk.memory.bytes() > 0) *work = Work();
            });
    }

    /// Throws FormatError.
    [[noreturn]] void fail(std::uint64_t line, const std::string& what) const;

  private:
    [[nodiscard]] std::uint64_t n_in_flight() const {
        const unsigned n_threads = import_.context().n_threads();
        return n_threads == 1 ? 1 : n_threads + 1;
    }
    static TextProblem too_long(const TextChunk& chunk);

    MeshImport& import_;
    TextChunks chunks_;
    ooc::Reservation memory_;
};

}  // namespace hewer::streaming
