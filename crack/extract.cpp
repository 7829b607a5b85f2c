#include "crack/extract.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/optional_effects.h"
#include "core/stopwatch.h"
#include "crack/detail/classify.h"
#include "crack/detail/debris.h"
#include "crack/detail/medial.h"
#include "crack/detail/sites.h"

namespace sunder::crack {

namespace {

constexpr double margin = 0.1;           // of the domain's diagonal, on every side of it
constexpr double shortest_edge = 1e-10;  // of the domain's diagonal: what geometry::cut can tell from nothing
constexpr double closing_gain = 1.02;    // neck closing roughens surfaces: it has to make more pieces by so much
constexpr double lump_depth = 1.5;       // in cell sizes
constexpr double usual_spacing = 0.8;    // of nodes, in spacings of the points
constexpr double finest = 0.75;          // in spacings of the points: finer lattices have nodes without points
constexpr double side_distance = 1.5;    // in node spacings: sites on the two sides of a crack are farther apart

using namespace detail;

void check(const DamageField& field, const Box& domain, const Settings& settings) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorKind::internal, "crack: " + what);
  };
  require(field.points.size() == field.damage.size(), std::to_string(field.points.size()) + " points but " +
                                                          std::to_string(field.damage.size()) + " damage values");
  require(field.damage_time.empty() || field.damage_time.size() == field.points.size(),
          "damage times do not fit the points");
  require(field.spacing > 0 && field.cell_size > 0, "spacing and cell size must be positive");
  require(!domain.isEmpty(), "the domain is empty");
  for (std::size_t i = 0; i < field.points.size(); ++i)
    if (!field.points[i].allFinite() || std::isnan(field.damage[i]))
      require(false, "point " + std::to_string(i) + " is not finite");
  if (settings.node_spacing != 0 && !(settings.node_spacing >= finest * field.spacing))
    throw Error(ErrorKind::usage, "crack: a node spacing of " + std::to_string(settings.node_spacing) +
                                      " m is finer than the points; make it at least " +
                                      std::to_string(finest * field.spacing) + " m");
}

void check(const Extraction& earlier, const DamageField& field, const Lattice& lattice) {
  const auto fits = [&](const Anchor& anchor) {
    return anchor.node >= 0 && anchor.node < lattice.count() && anchor.lattice >= 0 &&
           anchor.lattice < lattice.positions();
  };
  if (earlier.region.size() != field.points.size() ||
      !std::all_of(earlier.anchors.begin(), earlier.anchors.end(), fits))
    throw Error(ErrorKind::internal, "crack: the earlier extraction is one of another body");
}

/// Per region: the one of the earlier extraction that most of its points were in.
std::vector<int> earlier_regions(const std::vector<int>& region, const std::vector<int>& earlier, int count) {
  std::vector<std::map<int, int>> votes(static_cast<std::size_t>(count));
  for (std::size_t p = 0; p < region.size(); ++p) ++votes[static_cast<std::size_t>(region[p])][earlier[p]];
  std::vector<int> result;
  for (const std::map<int, int>& vote : votes) {
    const auto most =
        std::max_element(vote.begin(), vote.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    result.push_back(most == vote.end() ? -1 : most->first);
  }
  return result;
}

double damaged_share(const DamageField& field, double crack_damage) {
  const long damaged =
      std::count_if(field.damage.begin(), field.damage.end(), [&](double c) { return c >= crack_damage; });
  return field.damage.empty() ? 0 : static_cast<double>(damaged) / static_cast<double>(field.damage.size());
}

/// The sound nodes without those near damage: necks, and the borders of everything else.
std::vector<char> eroded(const Lattice& lattice, const std::vector<char>& sound, double radius) {
  std::vector<char> result = sound;
  for (char& mark : result) mark = !mark;
  result = dilated(lattice, result, radius);
  for (char& mark : result) mark = !mark;
  return result;
}

struct Choice {
  Partition partition;
  double neck_radius = 0;
};

/// With and without neck closing, whichever makes more pieces.
Choice choose_partition(const Lattice& lattice, const std::vector<char>& sound, const IslandRequest& request,
                        double radius) {
  Choice best{find_islands(lattice, sound, request), 0};
  if (radius > 0) {
    Partition closed = find_islands(lattice, eroded(lattice, sound, radius), request);
    if (effective_count(closed) > closing_gain * effective_count(best.partition)) best = {std::move(closed), radius};
  }
  flood_from_islands(lattice, best.partition);
  return best;
}

int smallest_island(const Lattice& lattice, const Settings& settings) {
  return std::max(settings.smallest_nodes,
                  static_cast<int>(std::ceil(settings.smallest_share * static_cast<double>(lattice.count()))));
}

/// The piece of the node nearest to every point. Pieces are renumbered by their lowest point, so that their numbers do
/// not depend on how the lattice lies.
std::vector<int> regions_of_points(const Raster& raster, Partition& pieces) {
  std::vector<int> number(static_cast<std::size_t>(pieces.count), -1), region;
  int next = 0;
  region.reserve(raster.nearest.size());
  for (const int node : raster.nearest) {
    int& renumbered = number[static_cast<std::size_t>(pieces.piece[static_cast<std::size_t>(node)])];
    if (renumbered < 0) renumbered = next++;
    region.push_back(renumbered);
  }
  for (int& renumbered : number)
    if (renumbered < 0) renumbered = next++;
  for (int& piece : pieces.piece) piece = number[static_cast<std::size_t>(piece)];
  return region;
}

std::vector<CrackFace> crack_faces(const Raster& raster, const std::vector<Site>& sites, const CellFaces& cells,
                                   double crack_damage) {
  std::vector<CrackFace> faces;
  const auto add = [&](const CellFace& face, FaceKind kind) {
    Vec3 middle = Vec3::Zero();
    for (const int v : face.loop) middle += cells.vertices[v] / static_cast<double>(face.loop.size());
    const bool in_body = raster.lattice.node_at(raster.lattice.nearest(middle)) >= 0;
    faces.push_back({face.loop, kind, sites[face.site].piece, sites[face.neighbour].piece,
                     damage_time_at(raster, middle), in_body});
  };
  const auto has_damage = [&](const CellFace& face) {
    return damage_between(raster, sites[face.site].position, sites[face.neighbour].position, crack_damage);
  };
  const auto one_side = [&](const CellFace& face) {
    return on_one_side(raster, sites[face.site].node, sites[face.neighbour].node, crack_damage);
  };
  for (const CellFace& face : cells.faces)
    if (face.neighbour >= 0) add(face, has_damage(face) ? FaceKind::interior : FaceKind::extension);
  for (const CellFace& face : cells.inner)
    if (has_damage(face) && !one_side(face)) add(face, FaceKind::partial);
  return faces;
}

Box enlarged(const DamageField& field, Box domain) {
  for (const Vec3& x : field.points) domain.extend(x);
  const double by = margin * domain.diagonal().norm();
  return {domain.min() - Vec3::Constant(by), domain.max() + Vec3::Constant(by)};
}

MedialRequest medial_request(const DamageField& field, const Box& domain, const Settings& settings, double spacing,
                             int pieces) {
  const double diagonal = domain.diagonal().norm();
  const CellRequest cells{.box = enlarged(field, domain),
                          .unit = spacing,
                          .shortest_edge = shortest_edge * diagonal,
                          .inner_distance = side_distance * spacing,
                          .pieces = pieces > 1};
  return {.cells = cells, .pieces = pieces, .jitter = settings.jitter * diagonal, .seed = settings.seed};
}

}  // namespace

Extraction extract(const DamageField& field, const Box& domain, const Settings& settings, Progress& progress,
                   const Extraction* earlier) {
  check(field, domain, settings);
  Extraction result;
  result.region.assign(field.points.size(), 0);
  result.node_spacing = settings.node_spacing > 0 ? settings.node_spacing : usual_spacing * field.spacing;
  result.damaged_share = damaged_share(field, settings.crack_damage);
  if (result.damaged_share == 0) return result;

  progress.checkpoint("extract", 0.1);
  const double spacing = result.node_spacing;
  const Raster raster = rasterise(field, domain, spacing, settings.crack_damage);
  if (earlier) check(*earlier, field, raster.lattice);
  const Crushed crushed = find_crushed(raster, settings.node_damage);
  result.lump_share = lump_share(raster.lattice, crushed, lump_depth * field.cell_size / spacing);
  IslandRequest islands{smallest_island(raster.lattice, settings), {}};
  if (with_optional_effects && settings.debris_size > 0) {
    const Stopwatch watch(result.debris_seconds);
    islands.seeds = debris_seeds(raster.lattice, crushed, settings.debris_size / spacing, settings.seed);
  }
  const double neck = settings.close_necks ? settings.neck_radius * field.cell_size / spacing : 0;
  auto [pieces, neck_radius] = choose_partition(raster.lattice, crushed.sound, islands, neck);
  if (neck_radius > 0) result.neck_radius_used = settings.neck_radius;
  if (pieces.count > 1) {
    result.region_count = pieces.count;
    result.debris = static_cast<int>(islands.seeds.size());
    result.region = regions_of_points(raster, pieces);
    result.effective_count = effective_count(pieces);
  }
  if (pieces.count == 0) return result;

  SiteRequest request{settings.node_damage, islands.seeds, {}, {}};
  if (earlier) {
    request.anchors = earlier->anchors;
    request.earlier_region = earlier_regions(result.region, earlier->region, pieces.count);
  }
  const std::vector<Site> sites = choose_sites(raster, pieces, request);
  Medial medial = medial_faces(sites, medial_request(field, domain, settings, spacing, pieces.count), progress);
  result.sites = static_cast<long>(sites.size());
  result.retries = medial.retries;
  result.faces = crack_faces(raster, sites, medial.cells, settings.node_damage);
  result.boundary = std::move(medial.boundary);
  result.vertices = std::move(medial.cells.vertices);
  for (const Vec3& x : result.vertices) result.damage_time.push_back(damage_time_at(raster, x));
  for (const Site& site : sites)
    if (site.is_border) result.anchors.push_back({site.lattice, site.node, site.position, site.piece});
  progress.report("extract", 1);
  return result;
}

}  // namespace sunder::crack
