#pragma once
/// Crack surfaces as files, for looking.
#include <filesystem>

#include "crack/extract.h"

namespace sunder::pipeline {

/// PLY (ASCII): the faces that lie in the body, each once, with `type` (0 interior, 1 extension, 2 partial),
/// `damage_time` [s] (-1: unknown), `region_a` and `region_b`, and a colour by type. Written atomically. Errors:
/// ErrorKind::io.
void write_crack_surface(const crack::Extraction& extraction, const std::filesystem::path& file);

}  // namespace sunder::pipeline
