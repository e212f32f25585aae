// SPDX-License-Identifier: MIT
#include "rsimp/part_contacts.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cell_mean.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/foreign_neighbours.h"

namespace hewer::rsimp {

using cluster::CellBlocks;
using cluster::CellRecord;

namespace {

constexpr std::uint32_t kManyParts = 0xffffffffU;

/// A cube of the octree that is as long as the distance or up to twice as long: some cells in a
/// row, and the part that all of them belong to. Cells without a face belong to none.
struct Cube {
    std::uint64_t code;
    std::uint64_t first_cell;
    std::uint32_t part;
    std::uint32_t is_contact;
};

/// The cells of cubes first_cube .. end_cube - 1 that are in contact, and those around them.
struct Tile {
    std::size_t first_cube;
    std::size_t end_cube;
    std::uint64_t n_cells;  // with those around
};

class Contacts {
  public:
    Contacts(ooc::Context& context, const CellBlocks& cells, CellParts& parts, double distance)
        : context_(context),
          cells_(cells),
          parts_(parts),
          distance_(distance),
          shift_(3 * static_cast<unsigned>(
                         std::max(0.0, std::ceil(std::log2(std::max(1.0, distance)))))) {
        const FacedCells faced(context, cells);
        name_parts(faced);
        find_cubes();
        find_contact_cubes();
        cut_tiles();
    }

    /// Of cells, by their first piece; kNoPart for those without a face.
    [[nodiscard]] ooc::Spool<std::uint32_t> take_names() { return std::move(names_); }

    /// take(contact, part of the other) one by one, by rising cell.
    template <typename Take>
    void for_each(const Take& take) const {
        struct Found {
            Contact contact;
            std::uint32_t other_part;
        };
        struct Work {
            std::vector<Found> found;
        };
        if (tiles_.empty()) return;
        std::uint64_t most = 0;
        for (const Tile& tile : tiles_) most = std::max(most, tile.n_cells);
        const auto in_flight = room_for(most);
        in_flight->template sweep<Work>(
            tiles_.size(),
            [&](std::uint64_t t, Work& work) {
                work.found.clear();
                Loaded loaded;
                load(tiles_[t], loaded);
                ForeignNeighbours neighbours(loaded.means, loaded.parts);
                std::vector<std::uint32_t> nearest;
                for (std::uint32_t i = 0; i < loaded.n_own; ++i) {
                    neighbours.nearest(i, distance_, nearest);
                    for (const std::uint32_t other : nearest) {
                        work.found.push_back({{loaded.ids[i], loaded.ids[other], loaded.parts[i],
                                               loaded.means[i] + loaded.origin},
                                              loaded.parts[other]});
                    }
                }
            },
            [&](std::uint64_t, const Work& work) {
                for (const Found& f : work.found) take(f.contact, f.other_part);
            });
    }

  private:
    struct Loaded {
        Vec3 origin{};
        std::vector<Vec3> means;  // relative to the origin; own cells first
        std::vector<std::uint32_t> parts;
        std::vector<std::uint32_t> ids;
        std::uint32_t n_own = 0;
    };
    static constexpr std::uint64_t kBytesPerCell = 64 + ForeignNeighbours::kBytesPerPoint;

    [[nodiscard]] std::unique_ptr<BlocksInFlight> room_for(std::uint64_t n_cells) const {
        try {
            return std::make_unique<BlocksInFlight>(context_, "close pairs of parts",
                                                    n_cells * kBytesPerCell);
        } catch (const OutOfMemoryBudget& e) {
            throw OutOfMemoryBudget(std::string(e.what()) +
                                    "; or a shorter --aggregate: " + std::to_string(n_cells) +
                                    " cells of the grid lie within that distance of each other");
        }
    }

    void name_parts(const FacedCells& faced) {
        ooc::Spool<std::uint32_t> names(context_, "parts, by cell");
        ooc::SpoolReader<std::uint32_t> pieces(parts_.pieces());
        for (std::uint64_t i = 0; i < cells_.n_cells(); ++i) {
            const std::uint32_t piece = *pieces.next();
            names.push(faced.has(i) ? static_cast<std::uint32_t>(parts_.part_of(piece)) : kNoPart);
        }
        names_ = std::move(names);
    }

    void find_cubes() {
        const auto sweep = [&](const auto& visit) {
            ooc::SpoolReader<std::uint64_t> codes(cells_.codes);
            ooc::SpoolReader<std::uint32_t> names(names_);
            for (std::uint64_t i = 0; i < cells_.n_cells(); ++i) {
                visit(i, *codes.next() >> shift_, *names.next());
            }
        };
        std::uint64_t n = 0;
        std::uint64_t last = ~std::uint64_t{0};
        sweep([&](std::uint64_t, std::uint64_t code, std::uint32_t) {
            if (code != last) ++n;
            last = code;
        });
        cubes_ = ooc::Array<Cube>(context_.budget(), "cubes of close parts", n + 1);
        std::uint64_t at = 0;
        last = ~std::uint64_t{0};
        sweep([&](std::uint64_t i, std::uint64_t code, std::uint32_t part) {
            if (code != last) cubes_[at++] = {code, i, kNoPart, 0};
            last = code;
            if (part == kNoPart) return;
            std::uint32_t& name = cubes_[at - 1].part;
            if (name != part) name = name == kNoPart ? part : kManyParts;
        });
        cubes_[n] = {~std::uint64_t{0}, cells_.n_cells(), kNoPart, 0};
        n_cubes_ = n;
    }

    [[nodiscard]] std::size_t find_cube(std::uint64_t code) const {
        const Cube* const end = cubes_.data() + n_cubes_;
        const Cube* const at = std::lower_bound(
            cubes_.data(), end, code, [](const Cube& c, std::uint64_t x) { return c.code < x; });
        return at != end && at->code == code ? static_cast<std::size_t>(at - cubes_.data())
                                             : n_cubes_;
    }

    void find_contact_cubes() {
        for (std::size_t i = 0; i < n_cubes_; ++i) {
            Cube& cube = cubes_[i];
            if (cube.part == kNoPart) continue;
            cube.is_contact =
                cube.part == kManyParts || any_neighbour(cube.code, [&](std::uint64_t code) {
                    const std::size_t j = find_cube(code);
                    return j < n_cubes_ && cubes_[j].part != kNoPart && cubes_[j].part != cube.part;
                });
        }
    }

    /// visit(cube) for the contact cubes of a tile, then for those around them.
    template <typename Visit>
    void for_cubes(const Tile& tile, const Visit& visit) const {
        std::vector<std::size_t> around;
        for (std::size_t i = tile.first_cube; i < tile.end_cube; ++i) {
            if (cubes_[i].is_contact == 0) continue;
            visit(i);
            any_neighbour(cubes_[i].code, [&](std::uint64_t code) {
                const std::size_t j = find_cube(code);
                const bool is_own = j >= tile.first_cube && j < tile.end_cube;
                if (j < n_cubes_ && !is_own && cubes_[j].part != kNoPart) around.push_back(j);
                return false;
            });
        }
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (const std::size_t i : around) visit(i);
    }
    [[nodiscard]] std::uint64_t cells_in(std::size_t cube) const {
        return cubes_[cube + 1].first_cell - cubes_[cube].first_cell;
    }

    void cut_tiles() {
        std::uint64_t n = 0;
        std::size_t first = 0;
        const auto end_tile = [&](std::size_t end) {
            if (n == 0) return;
            Tile tile{first, end, 0};
            for_cubes(tile, [&](std::size_t i) { tile.n_cells += cells_in(i); });
            tiles_.push_back(tile);
            n = 0;
        };
        for (std::size_t i = 0; i < n_cubes_; ++i) {
            if (cubes_[i].is_contact == 0) continue;
            if (n > 0 && n + cells_in(i) > kTileCells) end_tile(i);
            if (n == 0) first = i;
            n += cells_in(i);
        }
        end_tile(n_cubes_);
    }

    void load(const Tile& tile, Loaded& loaded) const {
        std::vector<std::uint64_t> codes;
        std::vector<CellRecord> records;
        std::vector<std::uint32_t> names;
        for_cubes(tile, [&](std::size_t i) {
            const std::uint64_t first = cubes_[i].first_cell;
            const std::uint64_t n = cells_in(i);
            codes.resize(n);
            records.resize(n);
            names.resize(n);
            cells_.codes.read(first, codes);
            cells_.cells.read(first, records);
            names_.read(first, names);
            if (loaded.ids.empty()) loaded.origin = cluster::center_of(codes[0]);
            for (std::uint64_t k = 0; k < n; ++k) {
                if (names[k] == kNoPart) continue;
                loaded.means.push_back(mean_of(codes[k], records[k]) - loaded.origin);
                loaded.parts.push_back(names[k]);
                loaded.ids.push_back(static_cast<std::uint32_t>(first + k));
            }
            if (i >= tile.first_cube && i < tile.end_cube) {
                loaded.n_own = static_cast<std::uint32_t>(loaded.ids.size());
            }
        });
    }

    ooc::Context& context_;
    const CellBlocks& cells_;
    CellParts& parts_;
    double distance_;
    unsigned shift_;  // of codes, to those of the cubes
    ooc::Spool<std::uint32_t> names_;
    ooc::Array<Cube> cubes_;  // and one more, for the end
    std::size_t n_cubes_ = 0;
    std::vector<Tile> tiles_;
};

}  // namespace

ooc::Spool<std::uint32_t> find_contacts(
    ooc::Context& context, const CellBlocks& cells, CellParts& parts, double distance,
    const std::function<void(const Contact&, std::uint32_t)>& take) {
    Contacts contacts(context, cells, parts, distance);
    contacts.for_each(take);
    return contacts.take_names();
}

}  // namespace hewer::rsimp
