#pragma once
/// Two runs of one build give the same if this is the same.
#include <string>

#include "pipeline/scene.h"

namespace sunder::pipeline {

/// All that decides what a run gives: the scene file, the presets, the mesh files, and what the command line changed.
/// 16 hexadecimal digits (FNV-1a).
std::string fingerprint(const Scene& scene);

}  // namespace sunder::pipeline
