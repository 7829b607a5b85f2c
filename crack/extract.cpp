#include "crack/extract.h"

#include <cmath>
#include <string>

#include "crack/detail/bins.h"
#include "crack/detail/classify.h"
#include "crack/detail/islands.h"
#include "crack/detail/medial.h"

namespace sunder::crack {

namespace {

constexpr double margin = 0.1;           // of the domain's diagonal, on every side of it
constexpr double shortest_edge = 1e-10;  // of the domain's diagonal: what geometry::cut can tell from nothing
constexpr double closing_gain = 1.02;    // neck closing roughens surfaces: it has to make more pieces by so much
constexpr double lump_depth = 1.5;       // in cell sizes

using namespace detail;

void check(const DamageField& field, const Box& domain) {
  if (field.points.size() != field.damage.size())
    throw Error(ErrorKind::internal, "crack: " + std::to_string(field.points.size()) + " points but " +
                                         std::to_string(field.damage.size()) + " damage values");
  if (!(field.spacing > 0) || !(field.cell_size > 0))
    throw Error(ErrorKind::internal, "crack: spacing and cell size must be positive");
  if (domain.isEmpty()) throw Error(ErrorKind::internal, "crack: the domain is empty");
  for (std::size_t i = 0; i < field.points.size(); ++i)
    if (!field.points[i].allFinite() || std::isnan(field.damage[i]))
      throw Error(ErrorKind::internal, "crack: point " + std::to_string(i) + " is not finite");
}

std::vector<int> indices_of(const std::vector<char>& marks, bool marked) {
  std::vector<int> result;
  for (int i = 0; i < static_cast<int>(marks.size()); ++i)
    if ((marks[i] != 0) == marked) result.push_back(i);
  return result;
}

std::vector<char> sound_points(const DamageField& field, double crack_damage) {
  std::vector<char> sound(field.points.size());
  for (std::size_t i = 0; i < sound.size(); ++i) sound[i] = field.damage[i] < crack_damage;
  return sound;
}

/// The sound points without those near damage: necks, and the borders of everything else.
std::vector<char> eroded(const DamageField& field, const std::vector<char>& sound, double radius) {
  const PointBins damaged(field.points, indices_of(sound, false), std::max(radius, field.spacing));
  std::vector<char> result = sound;
  for (std::size_t i = 0; i < sound.size(); ++i)
    if (sound[i] && damaged.any_within(field.points[i], radius)) result[i] = 0;
  return result;
}

double lump_share(const DamageField& field, const std::vector<char>& sound) {
  const PointBins near(field.points, indices_of(sound, true), field.cell_size);
  int deep = 0;
  for (int i : indices_of(sound, false)) deep += !near.any_within(field.points[i], lump_depth * field.cell_size);
  return static_cast<double>(deep) / static_cast<double>(sound.size());
}

struct Choice {
  Partition partition;
  double neck_radius = 0;
};

/// With and without neck closing, whichever makes more pieces.
Choice choose_partition(const DamageField& field, const LinkGraph& links, const std::vector<char>& sound,
                        const Settings& settings) {
  const int smallest =
      std::max(settings.smallest_points,
               static_cast<int>(std::ceil(settings.smallest_share * static_cast<double>(field.points.size()))));
  Choice plain{partition(field.points, links, sound, smallest, field.spacing), 0};
  if (!settings.close_necks || !(settings.neck_radius > 0)) return plain;
  const std::vector<char> solid = eroded(field, sound, settings.neck_radius * field.cell_size);
  Choice closed{partition(field.points, links, solid, smallest, field.spacing), settings.neck_radius};
  return closed.partition.effective_count > closing_gain * plain.partition.effective_count ? closed : plain;
}

/// The points that at most `hops` links part from one that is on no island.
std::vector<char> near_border(const LinkGraph& links, const Partition& pieces, int hops) {
  std::vector<char> near(pieces.is_island.size());
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = !pieces.is_island[i];
  for (int hop = 0; hop < hops; ++hop)
    for (const std::vector<char> before = near; int i : indices_of(before, true))
      for (int e = links.start[i]; e < links.start[i + 1]; ++e) near[links.neighbour[e]] = 1;
  return near;
}

/// Island points, and the points astray: they keep another limb's cells off. Of a single piece only those that partial
/// cracks need: the points beside damage, and one layer behind them that keeps cells from reaching through the body.
std::vector<Site> choose_sites(const DamageField& field, const LinkGraph& links, const Partition& pieces) {
  std::vector<Site> sites;
  if (pieces.count == 0) return sites;
  const std::vector<char> near = near_border(links, pieces, 2);
  for (int i = 0; i < static_cast<int>(field.points.size()); ++i)
    if ((pieces.is_island[i] || pieces.is_astray[i]) && (pieces.count > 1 || near[i]))
      sites.push_back({field.points[i], pieces.piece[i], i});
  return sites;
}

/// Does a way of two links over an island point join two points?
bool joined_by_two(const LinkGraph& links, const Partition& pieces, int a, int b) {
  for (int i = links.start[a], j = links.start[b]; i < links.start[a + 1] && j < links.start[b + 1];) {
    const int from_a = links.neighbour[i], from_b = links.neighbour[j];
    if (from_a == from_b && pieces.is_island[from_a]) return true;
    i += from_a <= from_b;
    j += from_b <= from_a;
  }
  return false;
}

/// Sites of one piece that a way of at most three links over island points joins are neighbours on a rough side of a
/// crack; those that none joins lie on its two sides.
bool on_one_side(const LinkGraph& links, const Partition& pieces, int a, int b) {
  if (joined_by_two(links, pieces, a, b)) return true;
  for (int e = links.start[a]; e < links.start[a + 1]; ++e)
    if (pieces.is_island[links.neighbour[e]] && joined_by_two(links, pieces, links.neighbour[e], b)) return true;
  return false;
}

std::vector<CrackFace> crack_faces(const DamageField& field, const std::vector<int>& damaged, const LinkGraph& links,
                                   const Partition& pieces, const std::vector<Site>& sites, const CellFaces& cells) {
  const DamageBetween damage_between(field.points, damaged, field.spacing);
  std::vector<CrackFace> faces;
  const auto has_damage = [&](int a, int b) { return damage_between(sites[a].position, sites[b].position); };
  for (const CellFace& face : cells.faces) {
    if (face.neighbour < 0) continue;
    CrackFace& crack = faces.emplace_back();
    for (int v : face.loop) crack.polygon.push_back(cells.vertices[v]);
    crack.kind = has_damage(face.site, face.neighbour) ? FaceKind::interior : FaceKind::extension;
    crack.point_a = sites[face.site].point;
    crack.point_b = sites[face.neighbour].point;
  }
  for (const InnerFace& face : cells.inner) {
    const int a = sites[face.site].point, b = sites[face.neighbour].point;
    if (has_damage(face.site, face.neighbour) && !on_one_side(links, pieces, a, b))
      faces.push_back({face.polygon, FaceKind::partial, a, b});
  }
  return faces;
}

Box enlarged(const DamageField& field, Box domain) {
  for (const Vec3& x : field.points) domain.extend(x);
  const double by = margin * domain.diagonal().norm();
  return {domain.min() - Vec3::Constant(by), domain.max() + Vec3::Constant(by)};
}

MedialRequest medial_request(const DamageField& field, const Box& domain, const Settings& settings, int pieces) {
  const double diagonal = domain.diagonal().norm();
  const CellRequest cells{.box = enlarged(field, domain),
                          .unit = field.spacing,
                          .shortest_edge = shortest_edge * diagonal,
                          .inner_distance = settings.link * field.spacing,
                          .pieces = pieces > 1};
  return {.cells = cells, .pieces = pieces, .jitter = settings.jitter * diagonal, .seed = settings.seed};
}

}  // namespace

Extraction extract(const DamageField& field, const Box& domain, const Settings& settings, Progress& progress) {
  check(field, domain);
  Extraction result;
  result.region.assign(field.points.size(), 0);
  const std::vector<char> sound = sound_points(field, settings.crack_damage);
  const std::vector<int> damaged = indices_of(sound, false);
  if (damaged.empty()) return result;
  result.damaged_share = static_cast<double>(damaged.size()) / static_cast<double>(sound.size());
  result.lump_share = lump_share(field, sound);

  progress.checkpoint("extract", 0.1);
  const LinkGraph links = link_graph(field.points, settings.link * field.spacing);
  const auto [pieces, neck_radius] = choose_partition(field, links, sound, settings);
  result.neck_radius_used = neck_radius;
  if (pieces.count > 1) {
    result.region_count = pieces.count;
    result.region = pieces.piece;
    result.effective_count = pieces.effective_count;
  }

  const std::vector<Site> sites = choose_sites(field, links, pieces);
  Medial medial = medial_faces(sites, medial_request(field, domain, settings, pieces.count), progress);
  result.retries = medial.retries;
  result.faces = crack_faces(field, damaged, links, pieces, sites, medial.cells);
  result.boundary = std::move(medial.boundary);
  progress.report("extract", 1);
  return result;
}

}  // namespace sunder::crack
