#include <array>
#include <charconv>
#include <string>
#include <string_view>

#include <tbb/parallel_for.h>

#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/writers.h"

namespace sunder::output {
namespace {

// 9 significant digits: what a reader with single precision needs to get every bit of it.
enum class Digits { nine, all };

// Text that grows at its end; numbers go straight into it.
class TextBuffer {
 public:
  explicit TextBuffer(std::size_t capacity, Digits digits = Digits::nine) : digits_(digits) { text_.reserve(capacity); }

  TextBuffer& operator<<(std::string_view text) {
    text_.append(text);
    return *this;
  }
  TextBuffer& operator<<(long value) { return append(value); }
  TextBuffer& operator<<(double value) {
    return digits_ == Digits::all ? append(value) : append(value, std::chars_format::general, 9);
  }

  const std::string& text() const { return text_; }

 private:
  template <class... Arguments>
  TextBuffer& append(Arguments... arguments) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), arguments...).ptr;
    text_.append(digits.data(), end);
    return *this;
  }

  Digits digits_;
  std::string text_;
};

void append_faces(TextBuffer& out, const Piece& piece, long first) {
  for (const auto& [material, faces] : detail::faces_by_material(piece)) {
    out << "usemtl " << piece.surface.material_names[static_cast<std::size_t>(material)] << "\n";
    for (const int face : faces) {
      const auto& [a, b, c] = piece.mesh.faces[static_cast<std::size_t>(face)];
      out << "f " << first + a << " " << first + b << " " << first + c << "\n";
    }
  }
}

// `first` is the OBJ number of the piece's first vertex; OBJ counts all vertices of a file from 1.
void append_piece(TextBuffer& out, const Piece& piece, const Pose& pose, long first) {
  out << "o " << piece.name << "\n";
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (const Vec3& vertex : piece.mesh.vertices) {
    const Vec3 x = rotation * vertex + pose.position;
    out << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
  }
  append_faces(out, piece, first);
}

std::size_t estimated_size(const geometry::TriangleMesh& mesh) {
  return 200 + 45 * mesh.vertices.size() + 24 * mesh.faces.size();
}

std::string frame_text(const Sequence& sequence, const Frame& frame) {
  detail::require_finite(sequence, frame);
  std::vector<const Piece*> pieces;
  std::vector<long> first = {1};
  for (const PiecePose& pose : frame.poses) {
    pieces.push_back(&sequence.pieces.at(static_cast<std::size_t>(pose.piece)));
    first.push_back(first.back() + static_cast<long>(pieces.back()->mesh.vertices.size()));
  }
  std::vector<std::string> texts(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    TextBuffer out(estimated_size(pieces[k]->mesh));
    append_piece(out, *pieces[k], frame.poses[k].pose, first[k]);
    texts[k] = out.text();
  });
  TextBuffer out(1000);
  out << "# " << sequence.name << ", " << frame.time << " s; metres, Y up\n";
  out << "mtllib " << sequence.name << ".mtl\ns off\n";
  for (const std::string& text : texts) out << text;
  return out.text();
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
  return out.text();
}

}  // namespace

std::string frame_number(long number) {
  const std::string digits = std::to_string(number);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

void write_obj_piece(const Piece& piece, const std::filesystem::path& file) {
  TextBuffer out(200 + 70 * piece.mesh.vertices.size() + 24 * piece.mesh.faces.size(), Digits::all);
  out << "# metres, Y up\no " << piece.name << "\n";
  for (const Vec3& x : piece.mesh.vertices) out << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
  append_faces(out, piece, 1);
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
