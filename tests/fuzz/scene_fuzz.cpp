/// Any bytes as a scene: it is read, or refused by an Error.
#include "core/error.h"
#include "pipeline/scene.h"
#include "tests/fuzz/bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunder;
  const fuzz::MemoryFile file(data, size);
  try {
    const pipeline::Scene scene = pipeline::load_scene(file.path());
    fuzz::require(!scene.bodies.empty(), "a scene that is read has a body");
    fuzz::require(scene.duration > 0 && scene.frame_rate > 0, "duration and frame rate are above zero");
    fuzz::require(scene.duration * scene.frame_rate <= 1e6, "a scene has at most a million frames");
  } catch (const Error& error) {
    fuzz::require(error.kind() != ErrorKind::internal, "bad input is no defect of the program");
    fuzz::require(error.what()[0] != '\0', "an error says something");
  }
  return 0;
}
