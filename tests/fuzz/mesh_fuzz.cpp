/// Any bytes as a mesh of a text or binary format: it is read, inspected and mended, or refused by an Error. The first
/// byte chooses the format.
#include <array>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "geometry/repair.h"
#include "tests/fuzz/bytes.h"

namespace {

constexpr std::array formats = {"obj", "off", "stl", "ply", "glb"};

/// Formats are told by the name's end.
std::filesystem::path named_file(const std::uint8_t* data, std::size_t size, const char* format) {
  static const std::string folder = [] {
    std::string pattern =
        std::filesystem::is_directory("/dev/shm") ? "/dev/shm/sunder_fuzz_XXXXXX" : "/tmp/sunder_fuzz_XXXXXX";
    if (!mkdtemp(pattern.data())) std::abort();
    return pattern;
  }();
  const std::filesystem::path file = std::filesystem::path(folder) / (std::string("mesh.") + format);
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunder;
  if (size < 2) return 0;
  const auto file = named_file(data + 1, size - 1, formats[data[0] % formats.size()]);
  try {
    const geometry::TexturedMesh read = geometry::load_textured_mesh(file);
    fuzz::require(!read.mesh.faces.empty(), "a mesh that is read has faces");
    fuzz::require(geometry::fits(read.attributes, read.mesh), "attributes fit their mesh");
    for (const Vec3& x : read.mesh.vertices) fuzz::require(x.allFinite(), "positions are finite");
    // Level sets take seconds, and are tested elsewhere.
    const geometry::RepairResult mended = geometry::repair(read.mesh, {.allow_remesh = false});
    if (mended.solid) {
      fuzz::require(geometry::inspect(mended.mesh).is_solid(), "what repair calls a solid is one");
      fuzz::require(geometry::mass_properties(mended.mesh).volume > 0, "a solid has a volume");
    }
  } catch (const Error& error) {
    fuzz::require(error.kind() != ErrorKind::internal, "bad input is no defect of the program");
  }
  return 0;
}
