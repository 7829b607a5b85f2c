#include "output/fragments_table.h"

#include <cmath>
#include <optional>

#include "core/error.h"
#include "geometry/shape_measures.h"
#include "output/atomic_file.h"
#include "output/detail/text_buffer.h"

namespace sunder::output {
namespace {

constexpr std::size_t kBytesPerRow = 700;

constexpr std::string_view kHeader =
    "id,name,body,parent,generation,material,birth_frame,birth_time_s,death_time_s,volume_m3,mass_kg,area_outside_m2,"
    "area_inside_m2,closed,sphericity,elongation,flatness,length_m,width_m,thickness_m,box_x_m,box_y_m,box_z_m,"
    "birth_x_m,birth_y_m,birth_z_m,birth_vx_m_s,birth_vy_m_s,birth_vz_m_s,birth_wx_rad_s,birth_wy_rad_s,birth_wz_rad_s,"
    "birth_speed_m_s,birth_kinetic_energy_J\r\n";

/// Cells of one row, with the commas between them.
class Row {
 public:
  Row(detail::TextBuffer& out, const Piece& piece) : out_(out), piece_(piece) {}
  ~Row() { out_ << "\r\n"; }
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  Row& operator<<(int value) {
    begin() << value;
    return *this;
  }
  Row& operator<<(double value) {
    if (!std::isfinite(value))
      throw Error(ErrorKind::internal, "piece '" + piece_.name + "' has a property that is not a number");
    begin() << value;
    return *this;
  }
  Row& operator<<(const std::optional<double>& value) {
    if (value) return *this << *value;
    begin();
    return *this;
  }
  Row& operator<<(const Vec3& values) { return *this << values.x() << values.y() << values.z(); }
  Row& operator<<(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
      begin() << text;
      return *this;
    }
    begin() << "\"";
    for (const char& c : text) out_ << (c == '"' ? std::string_view("\"\"") : std::string_view(&c, 1));
    out_ << "\"";
    return *this;
  }

 private:
  detail::TextBuffer& begin() { return first_ ? (first_ = false, out_) : out_ << ","; }

  detail::TextBuffer& out_;
  const Piece& piece_;
  bool first_ = true;
};

std::optional<double> when(bool there, double value) { return there ? std::optional(value) : std::nullopt; }

void append(detail::TextBuffer& out, const Sequence& sequence, const Piece& piece) {
  const auto shape = piece.closed ? geometry::shape_measures(geometry::mass_properties(piece.mesh)) : std::nullopt;
  const geometry::ShapeMeasures measures = shape.value_or(geometry::ShapeMeasures{});
  const Box box = geometry::bounds(piece.mesh);
  Row row(out, piece);
  row << piece.id << piece.name << piece.body << when(piece.parent >= 0, piece.parent) << piece.generation
      << piece.material << frame_at(piece.birth_time, sequence.frame_rate, sequence.start_frame) << piece.birth_time
      << when(std::isfinite(piece.death_time), piece.death_time) << piece.volume << piece.mass
      << piece.area - piece.inside_area << piece.inside_area << int(piece.closed);
  for (const double value : {measures.sphericity, measures.elongation, measures.flatness, measures.axes.x(),
                             measures.axes.y(), measures.axes.z()})
    row << when(shape.has_value(), value);
  row << (box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.sizes())) << piece.birth_position << piece.birth.linear
      << piece.birth.angular << piece.birth.linear.norm() << piece.birth_energy;
}

}  // namespace

void write_fragments_csv(const Sequence& sequence, const std::filesystem::path& file) {
  detail::TextBuffer out(kBytesPerRow * (1 + sequence.pieces.size()), detail::Digits::all);
  out << kHeader;
  for (const Piece& piece : sequence.pieces) append(out, sequence, piece);
  write_atomically(file, out.text());
}

}  // namespace sunder::output
