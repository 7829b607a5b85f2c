#include "crack/detail/medial.h"

#include <string>

#include "core/random.h"
#include "crack/detail/boundary.h"

namespace sunder::crack::detail {

namespace {

constexpr int most_tries = 8;

/// Every site displaced at random by up to `size` [m] along each axis, by its place on the lattice.
std::vector<Site> jittered(std::vector<Site> sites, double size, std::uint64_t seed, int attempt) {
  for (Site& site : sites)
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t stream = 3 * static_cast<std::uint64_t>(attempt) + axis;
      site.position[axis] += size * (2 * random_unit(seed, stream, site.lattice) - 1);
    }
  return sites;
}

}  // namespace

Medial medial_faces(const std::vector<Site>& sites, const MedialRequest& request, Progress& progress) {
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    progress.checkpoint("extract", 0.3 + 0.5 * attempt / most_tries);
    std::optional<CellFaces> cells = cell_faces(jittered(sites, request.jitter, request.seed, attempt), request.cells);
    if (!cells) continue;
    geometry::RegionBoundary boundary;
    if (request.cells.pieces) boundary = region_boundary(sites, *cells, request.pieces);
    if (is_closed(boundary)) return {std::move(*cells), std::move(boundary), attempt};
  }
  throw Error(ErrorKind::internal, "crack: Voronoi cells of " + std::to_string(sites.size()) +
                                       " points do not fit together after " + std::to_string(most_tries) +
                                       " tries; a larger crack jitter may help");
}

}  // namespace sunder::crack::detail
