#include <cstdio>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>

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

  bool operator==(const Numbers&) const = default;
};

// Faces of one material with what they carry.
struct Group {
  std::string material;
  detail::VertexArrays arrays;
};

std::vector<Group> groups_of(const Piece& piece) {
  std::vector<Group> groups;
  for (const auto& [material, faces] : detail::faces_by_material(piece))
    groups.push_back({piece.surface.material_names[static_cast<std::size_t>(material)],
                      detail::vertex_arrays(piece, faces, detail::has_texture(piece, faces))});
  return groups;
}

// Those of what follows the groups.
Numbers after(Numbers first, const std::vector<Group>& groups) {
  for (const Group& group : groups) {
    first.uv += static_cast<long>(group.arrays.uv.size());
    first.normal += static_cast<long>(group.arrays.normal.size());
  }
  return first;
}

void append_posed(TextBuffer& out, const Piece& piece, const std::vector<Group>& groups, const Pose& pose) {
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  out << "o " << piece.name << "\n";
  for (const Vec3& vertex : piece.mesh.vertices) {
    const Vec3 x = rotation * vertex + pose.position;
    out << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
  }
  for (const Group& group : groups)
    for (const auto& n : group.arrays.normal) {
      const Eigen::Vector3f turned = (rotation * Vec3(n[0], n[1], n[2])).cast<float>();
      out << "vn " << turned.x() << " " << turned.y() << " " << turned.z() << "\n";
    }
}

void append_texture(TextBuffer& out, const std::vector<Group>& groups) {
  for (const Group& group : groups)
    for (const auto& [u, v] : group.arrays.uv) out << "vt " << u << " " << v << "\n";
}

void append_faces(TextBuffer& out, const std::vector<Group>& groups, Numbers first) {
  for (const auto& [material, arrays] : groups) {
    const bool uv = !arrays.uv.empty(), normal = !arrays.normal.empty();
    out << "usemtl " << material << "\n";
    for (std::size_t c = 0; c < arrays.corner.size(); ++c) {
      const long corner = arrays.corner[c];
      out << (c % 3 == 0 ? "f " : " ") << first.position + arrays.vertex[static_cast<std::size_t>(corner)];
      if (uv) out << "/" << first.uv + corner;
      if (normal) out << (uv ? "/" : "//") << first.normal + corner;
      if (c % 3 == 2) out << "\n";
    }
    first.uv += static_cast<long>(arrays.uv.size());
    first.normal += static_cast<long>(arrays.normal.size());
  }
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
  const std::vector<Group> groups = groups_of(piece);
  constexpr std::size_t kBytesPerFace = 150;
  TextBuffer out(kBytesPerFace * piece.mesh.faces.size(), Digits::all);
  out << "# metres, Y up\n";
  append_posed(out, piece, groups, {});
  append_texture(out, groups);
  append_faces(out, groups, {});
  write_atomically(file, out.text());
}

void write_obj_materials(const Sequence& sequence, const std::filesystem::path& dir) {
  write_atomically(dir / (sequence.name + ".mtl"), material_text(sequence));
}

// Text of a piece. Only what its pose changes is written anew for every frame.
struct ObjFrames::Kept {
  explicit Kept(const Piece& piece) : groups(groups_of(piece)) { append_texture(texture, groups); }

  void number_from(const Numbers& numbers) {
    if (faces_from == numbers) return;
    faces_from = numbers;
    faces.clear();
    append_faces(faces, groups, numbers);
  }

  std::vector<Group> groups;
  TextBuffer posed, texture, faces;
  Numbers faces_from = {0, 0, 0};  // before the first frame
};

ObjFrames::ObjFrames() = default;
ObjFrames::~ObjFrames() = default;

void ObjFrames::write(const Sequence& sequence, std::size_t number, const std::filesystem::path& dir) {
  const Frame& frame = sequence.frames.at(number);
  detail::require_finite(sequence, frame);
  const std::size_t count = frame.poses.size();
  std::vector<std::unique_ptr<Kept>> alive(sequence.pieces.size());
  kept_.resize(sequence.pieces.size());
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    const std::size_t id = static_cast<std::size_t>(frame.poses[k].piece);
    alive[id] = kept_[id] ? std::move(kept_[id]) : std::make_unique<Kept>(sequence.pieces[id]);
  });
  kept_ = std::move(alive);
  std::vector<Numbers> first(1);
  for (const PiecePose& pose : frame.poses) {
    const std::size_t id = static_cast<std::size_t>(pose.piece);
    first.push_back(after(first.back(), kept_[id]->groups));
    first.back().position += static_cast<long>(sequence.pieces[id].mesh.vertices.size());
  }
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    const std::size_t id = static_cast<std::size_t>(frame.poses[k].piece);
    Kept& kept = *kept_[id];
    kept.posed.clear();
    append_posed(kept.posed, sequence.pieces[id], kept.groups, frame.poses[k].pose);
    kept.number_from(first[k]);
  });
  const std::string name = sequence.name + "." + frame_number(sequence.start_frame + static_cast<long>(number));
  write_atomically(dir / (name + ".obj"), [&](std::ostream& out) {
    TextBuffer head;
    head << "# " << sequence.name << ", " << frame.time << " s; metres, Y up\n";
    head << "mtllib " << sequence.name << ".mtl\ns off\n";
    out << head.text();
    for (const PiecePose& pose : frame.poses) {
      const Kept& kept = *kept_[static_cast<std::size_t>(pose.piece)];
      out << kept.posed.text() << kept.texture.text() << kept.faces.text();
    }
  });
}

}  // namespace sunder::output
