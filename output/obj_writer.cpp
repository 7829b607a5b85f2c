#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <tbb/parallel_for.h>

#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/text_buffer.h"
#include "output/detail/vertex_arrays.h"
#include "output/writers.h"

namespace sunder::output {
namespace {

using detail::Digits;
using detail::TextBuffer;

// OBJ counts positions, texture coordinates and normals of a whole file, each from 1.
struct Numbers {
  long position = 1, uv = 1, normal = 1;
};

// Faces of one material with what they carry.
struct Group {
  std::string_view material;
  detail::VertexArrays arrays;
};

struct ObjPiece {
  const Piece* piece = nullptr;
  std::vector<Group> groups;

  explicit ObjPiece(const Piece& source) : piece(&source) {
    for (const auto& [material, faces] : detail::faces_by_material(source))
      groups.push_back({source.surface.material_names[static_cast<std::size_t>(material)],
                        detail::vertex_arrays(source, faces, detail::has_texture(source, faces))});
  }

  // Those of what follows the piece.
  Numbers after(Numbers first) const {
    first.position += static_cast<long>(piece->mesh.vertices.size());
    for (const Group& group : groups) {
      first.uv += static_cast<long>(group.arrays.uv.size());
      first.normal += static_cast<long>(group.arrays.normal.size());
    }
    return first;
  }

  std::size_t estimated_size() const {
    std::size_t size = 200 + 70 * piece->mesh.vertices.size() + 24 * piece->mesh.faces.size();
    for (const auto& [material, arrays] : groups)
      size += 24 * arrays.uv.size() + 40 * arrays.normal.size() + 12 * arrays.corner.size();
    return size;
  }
};

void append_faces(TextBuffer& out, const Group& group, const Numbers& first) {
  const detail::VertexArrays& arrays = group.arrays;
  const bool uv = !arrays.uv.empty(), normal = !arrays.normal.empty();
  out << "usemtl " << group.material << "\n";
  for (std::size_t c = 0; c < arrays.corner.size(); ++c) {
    const long corner = arrays.corner[c];
    out << (c % 3 == 0 ? "f " : " ") << first.position + arrays.vertex[static_cast<std::size_t>(corner)];
    if (uv) out << "/" << first.uv + corner;
    if (normal) out << (uv ? "/" : "//") << first.normal + corner;
    if (c % 3 == 2) out << "\n";
  }
}

void append_piece(TextBuffer& out, const ObjPiece& source, const Pose& pose, Numbers first) {
  out << "o " << source.piece->name << "\n";
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (const Vec3& vertex : source.piece->mesh.vertices) {
    const Vec3 x = rotation * vertex + pose.position;
    out << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
  }
  for (const auto& [material, arrays] : source.groups) {
    for (const auto& [u, v] : arrays.uv) out << "vt " << u << " " << v << "\n";
    for (const auto& n : arrays.normal) {
      const Eigen::Vector3f turned = (rotation * Vec3(n[0], n[1], n[2])).cast<float>();
      out << "vn " << turned.x() << " " << turned.y() << " " << turned.z() << "\n";
    }
  }
  for (const Group& group : source.groups) {
    append_faces(out, group, first);
    first.uv += static_cast<long>(group.arrays.uv.size());
    first.normal += static_cast<long>(group.arrays.normal.size());
  }
}

std::string frame_text(const Sequence& sequence, const Frame& frame) {
  detail::require_finite(sequence, frame);
  const std::size_t count = frame.poses.size();
  std::vector<std::optional<ObjPiece>> pieces(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    pieces[k].emplace(sequence.pieces.at(static_cast<std::size_t>(frame.poses[k].piece)));
  });
  std::vector<Numbers> first(1);
  for (const auto& piece : pieces) first.push_back(piece->after(first.back()));
  std::vector<std::string> texts(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    TextBuffer out(pieces[k]->estimated_size());
    append_piece(out, *pieces[k], frame.poses[k].pose, first[k]);
    texts[k] = out.take();
  });
  std::size_t size = 200;
  for (const std::string& text : texts) size += text.size();
  TextBuffer out(size);
  out << "# " << sequence.name << ", " << frame.time << " s; metres, Y up\n";
  out << "mtllib " << sequence.name << ".mtl\ns off\n";
  for (const std::string& text : texts) out << text;
  return out.take();
}

void append_material(TextBuffer& out, std::string_view name, const detail::Look& look) {
  out << "newmtl " << name << "\n";
  out << "Kd " << look.colour[0] << " " << look.colour[1] << " " << look.colour[2] << "\n";
  out << "Pr " << look.roughness << "\nPm " << look.metallic << "\n";
}

std::string material_text(const Sequence& sequence) {
  TextBuffer out(1000);
  for (const auto& [name, substance] : detail::surface_materials(sequence))
    append_material(out, name, detail::look_of(name, substance));
  return out.take();
}

}  // namespace

std::string frame_number(long number) {
  char text[32];
  std::snprintf(text, sizeof text, "%s%04ld", number < 0 ? "-" : "", std::abs(number));
  return text;
}

void write_obj_piece(const Piece& piece, const std::filesystem::path& file) {
  const ObjPiece source(piece);
  TextBuffer out(source.estimated_size(), Digits::all);
  out << "# metres, Y up\n";
  append_piece(out, source, {}, {});
  write_atomically(file, out.text());
}

void write_obj_materials(const Sequence& sequence, const std::filesystem::path& dir) {
  write_atomically(dir / (sequence.name + ".mtl"), material_text(sequence));
}

void write_obj_frame(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir) {
  const std::string number = frame_number(static_cast<long>(sequence.start_frame) + static_cast<long>(frame));
  write_atomically(dir / (sequence.name + "." + number + ".obj"), frame_text(sequence, sequence.frames.at(frame)));
}

}  // namespace sunder::output
