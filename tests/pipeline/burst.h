#pragma once
/// A ball that bursts into many shards which fly apart and come to rest on the floor: what a run leaves, made up
/// without one, as large as a test wants it.
#include <filesystem>

namespace sunder::pipeline {

struct Burst {
  int shards = 27;
  int frames = 24;         ///< the ball is whole in the first tenth of them
  int subdivisions = 1;    ///< a shard has 20 * 4^n faces, every second one four times as many
  double frame_rate = 24;  ///< [1/s]
};

/// Writes report.json, fragments.glb, scene.toml and index.html.
void write_burst(const Burst& burst, const std::filesystem::path& folder);

}  // namespace sunder::pipeline
