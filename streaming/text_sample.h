// SPDX-License-Identifier: MIT
/// Counts of text formats, estimated.
#pragma once

#include "hewer/report.h"
#include "ooc/file.h"

namespace hewer::streaming {

/// Counts, attributes and the box of what is met in 128 pieces of 64 KiB at equal distances; the
/// counts are scaled up to the file. Where vertices and faces stand apart, as in most OBJ files,
/// they are right to within a per cent: the border between them lies within one of the pieces'
/// distances. A few milliseconds and 64 KiB of memory.
void sample_obj(const ooc::InputFile& file, InputReport& report);
void sample_ascii_stl(const ooc::InputFile& file, InputReport& report);

}  // namespace hewer::streaming
