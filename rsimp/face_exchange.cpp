// SPDX-License-Identifier: MIT
#include "rsimp/face_exchange.h"

#include <algorithm>

#include "hewer/error.h"

namespace hewer::rsimp {

namespace {

Face smallest_first(Face face) {
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    return face;
}

}  // namespace

FaceExchange::FaceExchange(ooc::Context& context)
    : context_(context), items_(context, "exchanged faces", Less{}, context.sort_bytes()) {}

void FaceExchange::add(const Face& before, const Face& after) {
    items_.add({smallest_first(before), 0});
    items_.add({smallest_first(after), 1});
    ++n_;
}

bool FaceExchange::carry_out(MeshStore& mesh) {
    if (n_ == 0) return false;
    auto items = items_.stream();
    const std::uint64_t n_faces = mesh.faces.size();
    ooc::Spool<Face> faces(context_, "faces");
    {
        ooc::SpoolReader<Face> old(mesh.faces);
        const Face* face = old.next();
        for (const Item* item = items.next(); item != nullptr; item = items.next()) {
            for (; face != nullptr && *face < item->face; face = old.next()) faces.push(*face);
            if (item->is_new != 0) {
                faces.push(item->face);
            } else if (face != nullptr && *face == item->face) {
                face = old.next();
            }
        }
        for (; face != nullptr; face = old.next()) faces.push(*face);
    }
    if (faces.size() != n_faces) throw InternalError("a face to be exchanged is not there");
    faces.seal();
    mesh.faces = std::move(faces);
    return true;
}

}  // namespace hewer::rsimp
