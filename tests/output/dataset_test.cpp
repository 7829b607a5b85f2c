/// Pieces as a learner loads them.
#include "output/dataset.h"

#include <array>
#include <cstdio>

#include <gtest/gtest.h>

#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "output/atomic_file.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

Piece piece(int id, const Vec3& size, const Vec3& offset) {
  Piece result;
  result.id = id;
  result.mesh = geometry::transformed(geometry::box(size), Mat3::Identity(), offset);
  result.source_face.assign(result.mesh.faces.size(), 3);
  result.source_face[0] = -1;
  result.volume = size.prod();
  return result;
}

/// Two boxes, side by side.
Sequence two_boxes() {
  Sequence sequence;
  sequence.pieces = {piece(0, Vec3(1, 1, 1), Vec3(0.5, 0, 0)), piece(1, Vec3(2, 1, 1), Vec3(2, 0, 0))};
  sequence.frames.resize(1);
  sequence.frames[0].poses = {{0, {}, {}}, {1, {}, {}}};
  return sequence;
}

std::string python(const ScratchFolder& folder, const std::string& program) {
  std::ofstream(folder / "look.py") << "import numpy\na = numpy.load('" << (folder / "pieces.npz").string() << "')\n"
                                    << program;
  FILE* pipe = popen(("/usr/bin/python3 " + (folder / "look.py").string() + " 2>&1").c_str(), "r");
  std::string said;
  std::array<char, 256> part;
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe)) said.append(part.data(), count);
  pclose(pipe);
  return said;
}

TEST(Dataset, PiecesLieAboutTheirCentresAndTransformsPutThemTogether) {
  const ScratchFolder folder;
  write_atomically(folder / "pieces.npz", pieces_npz(two_boxes(), 0, 0, 1));
  EXPECT_EQ(
      python(folder,
             "for p in range(2):\n"
             "  v = a['vertices'][a['vertex_offsets'][p]:a['vertex_offsets'][p + 1]]\n"
             "  m = a['transforms'][p]\n"
             "  w = v @ m[:3, :3].T + m[:3, 3]\n"
             "  print(v.min(0).tolist(), v.max(0).tolist(), w.min(0).tolist(), w.max(0).tolist())\n"
             "print(a['faces'].max(), a['face_offsets'].tolist(), a['face_inside'].sum(), a['face_source'].min(), "
             "a['volumes'].tolist(), 'points' in a.files)\n"),
      "[-0.5, -0.5, -0.5] [0.5, 0.5, 0.5] [0.0, -0.5, -0.5] [1.0, 0.5, 0.5]\n"
      "[-1.0, -0.5, -0.5] [1.0, 0.5, 0.5] [1.0, -0.5, -0.5] [3.0, 0.5, 0.5]\n"
      "15 [0, 12, 24] 2 -1 [1.0, 2.0] False\n");
}

TEST(Dataset, PointsAreDrawnEvenlyAndKnowTheirPiece) {
  const ScratchFolder folder;
  write_atomically(folder / "pieces.npz", pieces_npz(two_boxes(), 0, 4000, 1));
  // Areas 6 and 10; a point of piece 0 lies at x <= 1 and its normal is that of a box.
  const std::string said =
      python(folder,
             "p = a['points']; k = a['point_piece']\n"
             "print(len(p), bool(abs(k.mean() - 10 / 16) < 0.04), bool((p[k == 0][:, 0] <= 1).all()), "
             "bool((p[k == 1][:, 0] >= 1).all()), bool((abs(a['point_normals']).max(1) > 0.999).all()), "
             "bool(abs(a['point_inside'].mean() - (0.5 + 1 / 2) / 16) < 0.06))\n");
  EXPECT_EQ(said, "4000 True True True True True\n");
  EXPECT_EQ(pieces_npz(two_boxes(), 0, 50, 3), pieces_npz(two_boxes(), 0, 50, 3));
  EXPECT_NE(pieces_npz(two_boxes(), 0, 50, 3), pieces_npz(two_boxes(), 0, 50, 4));
}

}  // namespace
}  // namespace sunder::output
