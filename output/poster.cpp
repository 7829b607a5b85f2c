#include "output/poster.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "core/random.h"
#include "output/atomic_file.h"
#include "output/detail/render.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/smooth_light.h"
#include "output/detail/subject.h"
#include "output/detail/viewpoint.h"

namespace sunder::output {
namespace {

using namespace detail;

constexpr std::uint64_t kSeed = 0x7669657773;
constexpr std::size_t kSamples = 2000;  // points of the subject's surface that choose the viewpoint

const Piece& piece_of(const Sequence& sequence, const PiecePose& pose) {
  return sequence.pieces[static_cast<std::size_t>(pose.piece)];
}

/// Of the pieces with these poses, in the world. Empty floor: of a box of one metre on it.
std::vector<Vec3> subject_points(const Sequence& sequence, const Frame& frame, const std::vector<std::size_t>& poses,
                                 double floor) {
  std::vector<Vec3> points;
  for (const std::size_t i : poses) {
    const Pose& pose = frame.poses[i].pose;
    const Mat3 rotation = pose.orientation.toRotationMatrix();
    for (const Vec3& x : piece_of(sequence, frame.poses[i]).mesh.vertices)
      points.push_back(pose.position + rotation * x);
  }
  if (points.empty()) points = {Vec3(-0.5, floor, -0.5), Vec3(0.5, floor + 1, 0.5)};
  return points;
}

/// So that the middle of the points' box is the origin and half its diagonal is 1.
Placement placement_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& point : points) box.extend(point);
  const double size = box.diagonal().norm() / 2;
  return {box.center(), size > 0 ? 1 / size : 1};
}

/// Random points of the subject's surface, evenly by area; of its vertices if it has no area.
std::vector<Vec3> surface_samples(const Soup& soup, const std::vector<bool>& wanted, const std::vector<Vec3>& points) {
  std::vector<double> area_up_to;
  std::vector<std::size_t> triangles;
  double area = 0;
  const auto vertex = [&](std::size_t t, std::size_t k) -> Vec3 {
    return soup.vertices[static_cast<std::size_t>(soup.triangles[t][k])].cast<double>();
  };
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!wanted[static_cast<std::size_t>(soup.surface[t] / 2)]) continue;
    const Vec3 a = vertex(t, 0);
    area += (vertex(t, 1) - a).cross(vertex(t, 2) - a).norm() / 2;
    area_up_to.push_back(area);
    triangles.push_back(t);
  }
  if (area <= 0) return points;
  std::vector<Vec3> samples;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double at = area * random_unit(kSeed, 0, i);
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, at) - area_up_to.begin();
    const std::size_t t = triangles[static_cast<std::size_t>(found)];
    samples.push_back((vertex(t, 0) + vertex(t, 1) + vertex(t, 2)) / 3);
  }
  return samples;
}

Image developed_image(const std::vector<Pixel>& pixels, int width, int height) {
  Image image{width, height, {}};
  image.pixels.resize(pixels.size());
  tbb::parallel_for(std::size_t{0}, pixels.size(), [&](std::size_t i) {
    image.pixels[i] = developed(pixels[i].own + pixels[i].colour * pixels[i].light);
  });
  return image;
}

}  // namespace

Image poster_image(const Sequence& sequence, std::size_t frame_index, const PosterScene& scene,
                   const PosterSettings& settings) {
  const Frame frame = frame_index < sequence.frames.size() ? sequence.frames[frame_index] : Frame{};
  require_finite(sequence, frame);
  const std::vector<std::size_t> about = subject(sequence, frame);
  std::vector<Vec3> points = subject_points(sequence, frame, about, scene.ground_height.value_or(0));
  const Placement placement = placement_of(points);
  for (Vec3& point : points) point = placement * point;

  const Soup soup = soup_of(sequence, frame, placement);
  const RayScene rays(soup);
  std::vector<bool> wanted(sequence.pieces.size(), false);
  for (const std::size_t i : about) wanted[static_cast<std::size_t>(frame.poses[i].piece)] = true;
  View view{soup, rays, {}, {}, {}};
  const std::vector<Vec3> samples = surface_samples(soup, wanted, points);
  view.camera = viewpoint(rays, points, samples, static_cast<double>(settings.width) / settings.height, settings.fill);
  view.light = light_for(view.camera, rays, samples, scene.ground_height.has_value());
  if (scene.ground_height) view.floor = static_cast<float>((placement * Vec3(0, *scene.ground_height, 0)).y());
  view.width = settings.width;
  view.height = settings.height;
  view.samples = settings.samples;
  std::vector<Pixel> pixels = render(view);
  smooth_light(pixels, view.width, view.height);
  return developed_image(pixels, view.width, view.height);
}

std::string poster_png(const Sequence& sequence, std::size_t frame, const PosterScene& scene,
                       const PosterSettings& settings) {
  return to_png(poster_image(sequence, frame, scene, settings));
}

void write_poster(const Sequence& sequence, std::optional<double> ground_height, const std::filesystem::path& file,
                  const PosterSettings& settings) {
  write_atomically(file, poster_png(sequence, telling_frame(sequence), {ground_height}, settings));
}

}  // namespace sunder::output
