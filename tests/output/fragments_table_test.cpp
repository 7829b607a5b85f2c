/// fragments.csv, read back.
#include "output/fragments_table.h"

#include <map>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/output/example_sequence.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

/// Records of RFC 4180: cells with quotes, line ends within them.
std::vector<std::vector<std::string>> records(const std::string& text) {
  std::vector<std::vector<std::string>> result;
  std::vector<std::string> record(1);
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted && c == '"' && k + 1 < text.size() && text[k + 1] == '"') {
      record.back() += text[++k];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      record.emplace_back();
    } else if (!quoted && text.compare(k, 2, "\r\n") == 0) {
      result.push_back(record);
      record.assign(1, "");
      ++k;
    } else {
      record.back() += c;
    }
  }
  EXPECT_EQ(record, std::vector<std::string>(1)) << "the last record has no end";
  return result;
}

std::vector<std::map<std::string, std::string>> table(const Sequence& sequence) {
  const ScratchFolder folder;
  write_fragments_csv(sequence, folder / "fragments.csv");
  const auto lines = records(read_all(folder / "fragments.csv"));
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    EXPECT_EQ(lines[k].size(), lines[0].size());
    for (std::size_t c = 0; c < lines[k].size(); ++c) {
      if (c == 0) rows.emplace_back();
      rows.back()[lines[0][c]] = lines[k][c];
    }
  }
  return rows;
}

Sequence measured_sequence() {
  Sequence sequence = example_sequence();
  Piece& piece = sequence.pieces[1];
  piece.area = 1.7;
  piece.inside_area = 1.0 / 3;
  piece.closed = true;
  piece.birth = {Vec3(3, -4, 0), Vec3(0.1, 1.0 / 7, -2)};
  piece.birth_energy = 625.125;
  piece.birth_position = {0.1, 0.7, -1e-9};
  return sequence;
}

TEST(FragmentsTable, HoldsEveryPieceToTheLastBit) {
  const Sequence sequence = measured_sequence();
  const auto rows = table(sequence);
  ASSERT_EQ(rows.size(), 3u);
  const Piece& piece = sequence.pieces[1];
  auto row = rows[1];
  EXPECT_EQ(row["id"], "1");
  EXPECT_EQ(row["name"], "bar_0001");
  EXPECT_EQ(row["body"], "bar");
  EXPECT_EQ(row["parent"], "0");
  EXPECT_EQ(row["generation"], "1");
  EXPECT_EQ(row["material"], "glass");
  EXPECT_EQ(row["birth_frame"], "10");
  EXPECT_EQ(row["closed"], "1");
  const std::map<std::string, double> numbers = {{"birth_time_s", 0.2},
                                                 {"volume_m3", piece.volume},
                                                 {"mass_kg", piece.mass},
                                                 {"area_outside_m2", piece.area - piece.inside_area},
                                                 {"area_inside_m2", piece.inside_area},
                                                 {"box_x_m", 1},
                                                 {"box_z_m", 0.1234567891},
                                                 {"birth_y_m", 0.7},
                                                 {"birth_z_m", -1e-9},
                                                 {"birth_vy_m_s", -4},
                                                 {"birth_wy_rad_s", 1.0 / 7},
                                                 {"birth_speed_m_s", 5},
                                                 {"birth_kinetic_energy_J", 625.125}};
  for (const auto& [name, value] : numbers) EXPECT_EQ(std::stod(row[name]), value) << name;
}

/// Against the second moment of a tetrahedron, V / 20 sum (v - c)(v - c)^T (Tonon 2004), whose axes are 2 sqrt(5 l /
/// V).
TEST(FragmentsTable, ShapeIsThatOfTheMesh) {
  const Sequence sequence = measured_sequence();
  auto row = table(sequence)[1];
  Mat3 second = Mat3::Zero();
  Vec3 centre = Vec3::Zero();
  for (const Vec3& v : sequence.pieces[1].mesh.vertices) centre += v / 4;
  for (const Vec3& v : sequence.pieces[1].mesh.vertices) second += (v - centre) * (v - centre).transpose() / 20;
  const Vec3 l = Eigen::SelfAdjointEigenSolver<Mat3>(second).eigenvalues();
  EXPECT_NEAR(std::stod(row["length_m"]), 2 * std::sqrt(5 * l[2]), 1e-12);
  EXPECT_NEAR(std::stod(row["thickness_m"]), 2 * std::sqrt(5 * l[0]), 1e-12);
  EXPECT_NEAR(std::stod(row["elongation"]), std::sqrt(l[2] / l[1]), 1e-12);
  EXPECT_NEAR(std::stod(row["flatness"]), std::sqrt(l[1] / l[0]), 1e-12);
  EXPECT_GT(std::stod(row["sphericity"]), 0);
  EXPECT_LT(std::stod(row["sphericity"]), 1);
}

TEST(FragmentsTable, WhatDoesNotExistIsEmpty) {
  const auto rows = table(measured_sequence());
  EXPECT_EQ(rows[0].at("parent"), "");
  EXPECT_EQ(rows[1].at("parent"), "0");
  EXPECT_EQ(std::stod(rows[0].at("death_time_s")), 0.2);
  EXPECT_EQ(rows[1].at("death_time_s"), "");
  EXPECT_EQ(rows[0].at("closed"), "0");
  for (const char* shape : {"sphericity", "elongation", "flatness", "length_m", "width_m", "thickness_m"})
    EXPECT_EQ(rows[0].at(shape), "") << shape;
}

TEST(FragmentsTable, NamesMayHoldAnything) {
  Sequence sequence = measured_sequence();
  sequence.pieces[2].name = "a \"b\", c\r\nd";
  EXPECT_EQ(table(sequence)[2].at("name"), "a \"b\", c\r\nd");
}

TEST(FragmentsTable, RefusesWhatIsNotANumber) {
  const ScratchFolder folder;
  Sequence sequence = measured_sequence();
  sequence.pieces[2].birth.angular.z() = NAN;
  EXPECT_THROW(write_fragments_csv(sequence, folder / "fragments.csv"), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace sunder::output
