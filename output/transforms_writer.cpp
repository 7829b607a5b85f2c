#include "output/atomic_file.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/text_buffer.h"
#include "output/writers.h"

namespace sunder::output {
namespace {

using detail::Digits;
using detail::TextBuffer;

constexpr std::size_t kBytesPerRow = 400;

// Calls `row(frame number, time, piece, pose)` for every pose.
template <class Row>
void for_each_pose(const Sequence& sequence, const Row& row) {
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    const Frame& frame = sequence.frames[f];
    detail::require_finite(sequence, frame);
    for (const PiecePose& pose : frame.poses)
      row(sequence.start_frame + static_cast<int>(f), frame.time,
          sequence.pieces.at(static_cast<std::size_t>(pose.piece)), pose);
  }
}

std::size_t pose_count(const Sequence& sequence) {
  std::size_t count = 0;
  for (const Frame& frame : sequence.frames) count += frame.poses.size();
  return count;
}

template <class Vector>
void append(TextBuffer& out, const Vector& values, std::string_view separator) {
  for (int i = 0; i < values.size(); ++i) out << (i > 0 ? separator : "") << values[i];
}

}  // namespace

void write_transforms_csv(const Sequence& sequence, const std::filesystem::path& file) {
  TextBuffer out(kBytesPerRow * (1 + pose_count(sequence)), Digits::all);
  out << "frame,time_s,id,name,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n";
  for_each_pose(sequence, [&](int frame, double time, const Piece& piece, const PiecePose& pose) {
    out << frame << "," << time << "," << piece.id << "," << piece.name << ",";
    append(out, pose.pose.position, ",");
    out << ",";
    append(out, pose.pose.orientation.coeffs(), ",");
    out << ",";
    append(out, pose.twist.linear, ",");
    out << ",";
    append(out, pose.twist.angular, ",");
    out << "\n";
  });
  write_atomically(file, out.text());
}

void write_transforms_jsonl(const Sequence& sequence, const std::filesystem::path& file) {
  TextBuffer out(kBytesPerRow * (1 + pose_count(sequence)), Digits::all);
  for_each_pose(sequence, [&](int frame, double time, const Piece& piece, const PiecePose& pose) {
    out << "{\"frame\":" << frame << ",\"time\":" << time << ",\"id\":" << piece.id << ",\"name\":\"" << piece.name
        << "\",\"position\":[";
    append(out, pose.pose.position, ",");
    out << "],\"orientation\":[";
    append(out, pose.pose.orientation.coeffs(), ",");
    out << "],\"velocity\":[";
    append(out, pose.twist.linear, ",");
    out << "],\"angular_velocity\":[";
    append(out, pose.twist.angular, ",");
    out << "]}\n";
  });
  write_atomically(file, out.text());
}

}  // namespace sunder::output
