#include "pipeline/crack_writer.h"

#include <array>
#include <sstream>

#include "output/atomic_file.h"

namespace sunder::pipeline {
namespace {

constexpr std::array<const char*, 3> colours = {"200 60 40", "230 180 60", "60 110 200"};  // by type

}  // namespace

void write_crack_surface(const crack::Extraction& extraction, const std::filesystem::path& file) {
  std::vector<int> number(extraction.vertices.size(), -1);
  std::ostringstream vertices, faces;
  vertices.precision(17);
  int vertex_count = 0, face_count = 0;
  for (const crack::CrackFace& face : extraction.faces) {
    if (!face.in_body) continue;
    ++face_count;
    faces << face.loop.size();
    for (const int v : face.loop) {
      int& n = number[static_cast<std::size_t>(v)];
      if (n < 0) {
        n = vertex_count++;
        const Vec3& x = extraction.vertices[static_cast<std::size_t>(v)];
        vertices << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
      }
      faces << ' ' << n;
    }
    const int type = static_cast<int>(face.kind);
    faces << ' ' << type << ' ' << face.damage_time << ' ' << face.region_a << ' ' << face.region_b << ' '
          << colours[static_cast<std::size_t>(type)] << '\n';
  }
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\ncomment crack surface; metres; type: 0 interior, 1 extension, 2 partial\n"
      << "element vertex " << vertex_count << "\nproperty double x\nproperty double y\nproperty double z\n"
      << "element face " << face_count << "\nproperty list uchar int vertex_indices\nproperty uchar type\n"
      << "property double damage_time\nproperty int region_a\nproperty int region_b\nproperty uchar red\n"
      << "property uchar green\nproperty uchar blue\nend_header\n"
      << vertices.str() << faces.str();
  output::write_atomically(file, out.str());
}

}  // namespace sunder::pipeline
