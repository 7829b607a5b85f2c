/// The still of a run: image statistics with known answers, and the frame that it shows.
#include "output/poster.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <png.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "geometry/primitives.h"
#include "tests/output/example_sequence.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

constexpr int kWidth = 320, kHeight = 180;

PosterSettings small_settings() {
  PosterSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  return settings;
}

/// A body that stands still where its mesh is.
Piece body(geometry::TriangleMesh mesh, const std::string& material) {
  Piece piece;
  piece.name = piece.body = "body";
  piece.mesh = std::move(mesh);
  piece.source_face.assign(piece.mesh.faces.size(), 0);
  piece.surface.material.assign(piece.mesh.faces.size(), 0);
  piece.surface.material_names = {outside_material(material)};
  piece.material = material;
  piece.volume = piece.mass = 1;
  return piece;
}

Sequence still_life(std::vector<Piece> pieces, const std::vector<Vec3>& places) {
  Sequence sequence;
  sequence.frames.resize(1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    pieces[i].id = static_cast<int>(i);
    sequence.frames[0].poses.push_back({pieces[i].id, {places[i], Quat::Identity()}, {}});
  }
  sequence.pieces = std::move(pieces);
  return sequence;
}

double brightness(const Image& image, int column, int row) {
  const auto& pixel = image.pixels[static_cast<std::size_t>(row * image.width + column)];
  return (pixel[0] + pixel[1] + pixel[2]) / 3.0;
}

TEST(Poster, ASphereIsADiscOfTheSizeThatWasAskedForInTheMiddle) {
  const Sequence sequence = still_life({body(geometry::sphere(0.5, 5), "terracotta")}, {Vec3(3, 7, -2)});
  const Image image = poster_image(sequence, 0, {}, small_settings());
  const double radius = small_settings().fill * kHeight / 2;
  // Half a pixel for where its middle lies, half a pixel of the tent that smooths edges.
  constexpr double kPixel = 1;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const double distance = std::hypot(column + 0.5 - kWidth / 2.0, row + 0.5 - kHeight / 2.0);
      const auto& pixel = image.pixels[static_cast<std::size_t>(row * kWidth + column)];
      if (distance < radius - kPixel) {
        ASSERT_GT(pixel[0], pixel[2] + 15) << "terracotta is red at " << column << ", " << row;
      }
      if (distance > radius + kPixel) {
        ASSERT_LT(pixel[0], pixel[2]) << "the backdrop is blue at " << column << ", " << row;
      }
    }
}

/// Brightness outside a disc in the middle, one half of the picture.
std::vector<double> beside_disc(const Image& image, double radius, bool right) {
  std::vector<double> values;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      if (std::hypot(column - image.width / 2.0, row - image.height / 2.0) > radius &&
          (column > image.width / 2) == right)
        values.push_back(brightness(image, column, row));
  std::sort(values.begin(), values.end());
  return values;
}

TEST(Poster, TheShadowOnTheFloorIsDarkerThanTheFloor) {
  const Sequence sequence = still_life({body(geometry::sphere(0.5, 4), "plaster")}, {Vec3(0, 0.5, 0)});
  const double radius = small_settings().fill * kHeight / 2 + 2;
  const Image on_floor = poster_image(sequence, 0, {0.0}, small_settings());
  const std::vector<double> left = beside_disc(on_floor, radius, false), right = beside_disc(on_floor, radius, true);
  const double floor = left[left.size() / 2];
  // The sun stands on the left. Sky alone gives the floor less than half its light, which the tone curve keeps.
  EXPECT_LT(right[right.size() / 100], 0.6 * floor);
  EXPECT_GT(left[left.size() / 4], 0.9 * floor);

  const Image in_the_air = poster_image(sequence, 0, {}, small_settings());
  const std::vector<double> backdrop = beside_disc(in_the_air, radius, true);
  EXPECT_GT(backdrop.front(), 0.6 * backdrop.back()) << "without a floor there is no shadow";
}

/// Pixels in which red exceeds blue by so much that neither floor, backdrop nor plaster make it.
int red_pixels(const Image& image) {
  return static_cast<int>(std::count_if(image.pixels.begin(), image.pixels.end(),
                                        [](const auto& pixel) { return pixel[0] > pixel[2] + 30; }));
}

/// A terracotta ball that moves, and a body that stands still.
Sequence ball_and(Piece other, const Vec3& place) {
  Sequence sequence =
      still_life({body(geometry::sphere(0.5, 4), "terracotta"), std::move(other)}, {Vec3(0, 0.5, 0), place});
  sequence.pieces[0].body = "ball";
  sequence.frames.push_back(sequence.frames[0]);
  sequence.frames[0].poses[0].pose.position.x() = -3;
  return sequence;
}

TEST(Poster, IsFramedOnWhatMovesAndSeesPastWhatStandsInTheWay) {
  const double radius = small_settings().fill * kHeight / 2;
  const double disc = std::numbers::pi * radius * radius;
  // A floor slab a hundred times as large, and a wall between the ball and where the camera stands first.
  const Sequence slab = ball_and(body(geometry::box({100, 1, 100}), "plaster"), Vec3(0, -0.5, 0));
  const Sequence wall = ball_and(body(geometry::box({20, 8, 0.1}), "plaster"), Vec3(0, 4, 1));
  for (const Sequence& sequence : {slab, wall}) {
    const int seen = red_pixels(poster_image(sequence, 1, {}, small_settings()));
    EXPECT_GT(seen, 0.85 * disc) << "its dark side is less red than asked";
    EXPECT_LT(seen, 1.1 * disc) << "bounced light is not in the picture";
  }
}

TEST(Poster, CrackFacesHaveTheirOwnColour) {
  Piece whole = body(geometry::box({1, 1, 1}), "terracotta");
  Piece cracked = whole;
  cracked.surface.material_names = {inside_material("terracotta")};
  cracked.source_face.assign(cracked.mesh.faces.size(), -1);
  const auto mean_green = [&](const Piece& piece) {
    const Image image = poster_image(still_life({piece}, {Vec3::Zero()}), 0, {}, small_settings());
    double sum = 0;
    for (int row = 80; row < 100; ++row)
      for (int column = 150; column < 170; ++column)
        sum += image.pixels[static_cast<std::size_t>(row * kWidth + column)][1] / 400.0;
    return sum;
  };
  // Of the two looks green differs most: 0.20 and 0.32 in linear light.
  EXPECT_GT(mean_green(cracked), mean_green(whole) + 15);
}

TEST(Poster, VertexColoursAreShown) {
  Piece green = body(geometry::sphere(0.5, 4), "plaster");
  green.surface.colour.assign(green.mesh.faces.size(), {geometry::Colour(0, 1, 0, 1), geometry::Colour(0, 1, 0, 1),
                                                        geometry::Colour(0, 1, 0, 1)});
  const Image image = poster_image(still_life({green}, {Vec3::Zero()}), 0, {}, small_settings());
  const auto& middle = image.pixels[static_cast<std::size_t>(kHeight / 2 * kWidth + kWidth / 2)];
  EXPECT_GT(middle[1], middle[0] + 50);
  EXPECT_GT(middle[1], middle[2] + 50);
}

TEST(Poster, OneSeesThroughGlass) {
  // The ball within a shell of the two materials; of both the shell moves.
  const auto in_shell = [](const std::string& material) {
    Sequence sequence = ball_and(body(geometry::hollow_sphere(0.8, 0.05), material), Vec3(0, 0.5, 0));
    sequence.frames[0].poses[1].pose.position.x() = -3;
    return red_pixels(poster_image(sequence, 1, {0.0}, small_settings()));
  };
  EXPECT_EQ(in_shell("plaster"), 0);
  EXPECT_GT(in_shell("glass"), 3000);
}

TEST(Poster, WithoutPiecesItIsTheEmptyFloor) {
  const Image none = poster_image({}, 0, {0.0}, small_settings());
  EXPECT_EQ(static_cast<int>(none.pixels.size()), kWidth * kHeight);
  // Only the light's fall towards the backdrop is seen.
  std::vector<double> values = beside_disc(none, 0, true);
  EXPECT_GT(values.front(), 0.6 * values.back());
  EXPECT_GT(values.front(), 20);
}

TEST(Poster, TheSameBytesForAnyNumberOfThreads) {
  // Two balls in one place: which of them a ray meets first is left to the search, which must not ask the threads.
  const auto ball = [](const std::string& material) { return body(geometry::sphere(0.5, 5), material); };
  const Sequence sequence = still_life({ball("terracotta"), ball("plaster"), ball("glass"), ball("ice")},
                                       {Vec3(0, 0.5, 0), Vec3(0, 0.5, 0), Vec3(0.6, 0.5, 0), Vec3(0.6, 0.5, 0)});
  std::vector<Image> images;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    images.push_back(poster_image(sequence, 0, {0.0}, small_settings()));
  }
  EXPECT_EQ(images[0], images[1]);
  EXPECT_EQ(images[0], images[2]);
}

TEST(Poster, ThePngHoldsThePixels) {
  const Image image = poster_image(example_sequence(), 3, {-1.0}, small_settings());
  const std::string bytes = to_png(image);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()));
  header.format = PNG_FORMAT_RGB;
  Image read{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  read.pixels.resize(image.pixels.size());
  ASSERT_EQ(PNG_IMAGE_SIZE(header), 3 * read.pixels.size());
  ASSERT_TRUE(png_image_finish_read(&header, nullptr, read.pixels.data(), 0, nullptr));
  EXPECT_EQ(read, image);
}

TEST(Poster, IsWrittenWholeOrRefusedAsAFile) {
  const ScratchFolder folder;
  const Sequence sequence = example_sequence();
  write_poster(sequence, -1.0, folder / "poster.png", small_settings());
  EXPECT_EQ(read_all(folder / "poster.png"), poster_png(sequence, telling_frame(sequence), {-1.0}, small_settings()));
  EXPECT_EQ(folder.file_count(), 1u);
  try {
    write_poster(sequence, -1.0, folder / "missing" / "poster.png", small_settings());
    FAIL() << "there is no such folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
  }
}

}  // namespace
}  // namespace sunder::output
