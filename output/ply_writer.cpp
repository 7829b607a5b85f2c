#include <algorithm>
#include <cmath>
#include <cstring>

#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/text_buffer.h"
#include "output/writers.h"

namespace sunder::output {
namespace {

// Binary values one after another, as they lie in a little-endian file.
class ByteBuffer {
 public:
  explicit ByteBuffer(std::string head, std::size_t capacity) : bytes_(std::move(head)) {
    bytes_.reserve(bytes_.size() + capacity);
  }
  template <class Value>
  void add(Value value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes_.append(raw, sizeof value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

struct Sizes {
  std::size_t vertices = 0, faces = 0;
};

Sizes sizes_of(const Sequence& sequence, const Frame& frame) {
  Sizes sizes;
  for (const PiecePose& pose : frame.poses) {
    const geometry::TriangleMesh& mesh = sequence.pieces.at(static_cast<std::size_t>(pose.piece)).mesh;
    sizes.vertices += mesh.vertices.size();
    sizes.faces += mesh.faces.size();
  }
  return sizes;
}

std::string header(const Sequence& sequence, std::size_t frame, const Sizes& sizes) {
  detail::TextBuffer out(4000);
  out << "ply\nformat binary_little_endian 1.0\ncomment " << sequence.name << ", frame "
      << sequence.start_frame + static_cast<int>(frame) << ", " << sequence.frames[frame].time << " s; metres, Y up\n";
  for (const PiecePose& pose : sequence.frames[frame].poses)
    out << "comment piece " << pose.piece << " " << sequence.pieces[static_cast<std::size_t>(pose.piece)].name << "\n";
  out << "element vertex " << static_cast<long>(sizes.vertices)
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty int piece\nproperty float damage_time\n"
      << "element face " << static_cast<long>(sizes.faces)
      << "\nproperty list uchar int vertex_indices\nproperty int piece\nproperty int source_face\nproperty uchar "
         "inside\n"
      << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  return out.take();
}

// The latest of the corners' times at each vertex; -1: none has one.
std::vector<float> damage_times(const Piece& piece) {
  std::vector<float> times(piece.mesh.vertices.size(), -1);
  for (std::size_t f = 0; f < piece.surface.damage_time.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      float& time = times[static_cast<std::size_t>(piece.mesh.faces[f][k])];
      time = std::max(time, static_cast<float>(piece.surface.damage_time[f][k]));
    }
  return times;
}

void add_vertices(ByteBuffer& out, const Piece& piece, const Pose& pose) {
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  const std::vector<float> times = damage_times(piece);
  for (std::size_t v = 0; v < times.size(); ++v) {
    const Eigen::Vector3f x = (rotation * piece.mesh.vertices[v] + pose.position).cast<float>();
    for (int axis = 0; axis < 3; ++axis) out.add(x[axis]);
    out.add<std::int32_t>(piece.id);
    out.add(times[v]);
  }
}

// Linear light to the bytes that viewers expect in colours (sRGB, IEC 61966-2-1).
std::uint8_t srgb(double linear) {
  const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

void add_faces(ByteBuffer& out, const Piece& piece, std::int32_t first) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  for (const std::string& name : piece.surface.material_names) {
    const auto& colour = detail::look_of(name, piece.material).colour;
    colours.push_back({srgb(colour[0]), srgb(colour[1]), srgb(colour[2])});
  }
  for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
    out.add<std::uint8_t>(3);
    for (const int vertex : piece.mesh.faces[f]) out.add<std::int32_t>(first + vertex);
    out.add<std::int32_t>(piece.id);
    out.add<std::int32_t>(piece.source_face[f]);
    out.add<std::uint8_t>(piece.inside(f));
    for (const std::uint8_t channel : colours[static_cast<std::size_t>(piece.surface.material[f])]) out.add(channel);
  }
}

}  // namespace

void write_ply_frame(const Sequence& sequence, std::size_t frame, const std::filesystem::path& dir) {
  const Frame& written = sequence.frames.at(frame);
  detail::require_finite(sequence, written);
  const Sizes sizes = sizes_of(sequence, written);
  constexpr std::size_t kBytesPerVertex = 20, kBytesPerFace = 25;
  ByteBuffer out(header(sequence, frame, sizes), kBytesPerVertex * sizes.vertices + kBytesPerFace * sizes.faces);
  for (const PiecePose& pose : written.poses)
    add_vertices(out, sequence.pieces[static_cast<std::size_t>(pose.piece)], pose.pose);
  std::int32_t first = 0;
  for (const PiecePose& pose : written.poses) {
    const Piece& piece = sequence.pieces[static_cast<std::size_t>(pose.piece)];
    add_faces(out, piece, first);
    first += static_cast<std::int32_t>(piece.mesh.vertices.size());
  }
  const std::string number = frame_number(static_cast<long>(sequence.start_frame) + static_cast<long>(frame));
  write_atomically(dir / (sequence.name + "." + number + ".ply"), out.bytes());
}

}  // namespace sunder::output
