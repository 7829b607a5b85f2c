#include "crack/detail/sites.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "crack/detail/nearest.h"

namespace sunder::crack::detail {

namespace {

using Index = std::size_t;

constexpr double farthest_move = 0.75;  // of a site off its node, in spacings: sites of neighbours stay apart
constexpr int most_rounds = 6;          // strays of one round attract a few others in the next
constexpr double slack = 1;             // in spacings: how exact distances along links are

/// A linear fit to the damage of a node and those that links join to it.
struct Fit {
  double value = 0;
  Vec3 gradient = Vec3::Zero();  // per spacing
  Vec3 outward = Vec3::Zero();   // sum of the directions to neighbours that the body does not have
};

/// Neighbours that the body does not have count as the node itself: fits to what is there turned out worse.
Fit linear_fit(const Raster& raster, int node) {
  constexpr std::array<std::array<int, 3>, 9> half_of_links = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}};
  constexpr double second_moment = 10;  // sum of the squares of a coordinate over all links
  const auto value = [&](int other) { return raster.damage[static_cast<Index>(other < 0 ? node : other)]; };
  Fit fit{value(node), Vec3::Zero(), Vec3::Zero()};
  for (const auto& [i, j, k] : half_of_links) {
    const Vec3 direction(i, j, k);
    const int step = raster.lattice.step(i, j, k), position = raster.lattice.position(node);
    const int ahead = raster.lattice.node_at(position + step), behind = raster.lattice.node_at(position - step);
    fit.value += value(ahead) + value(behind);
    fit.gradient += (value(ahead) - value(behind)) / second_moment * direction;
    fit.outward += ((ahead < 0) - (behind < 0)) * direction;
  }
  fit.value /= 1 + 2 * half_of_links.size();
  return fit;
}

class Chooser {
 public:
  Chooser(const Raster& raster, const Partition& pieces, const SiteRequest& request)
      : raster_(raster),
        lattice_(raster.lattice),
        pieces_(pieces),
        request_(request),
        taken_(static_cast<Index>(lattice_.positions()), 0),
        owner_(static_cast<Index>(lattice_.positions()), -1) {}

  std::vector<Site> run() {
    add_anchors();
    for (int node = 0; node < lattice_.count(); ++node)
      if (is_sound(node) && !is_taken(node) && is_border(node)) add_border(node);
    for (const int seed : request_.seeds) add_node(seed, lattice_.point(seed), false);
    for (const Site& ghost : ghosts_) add(ghost);
    add_fillers();
    if (pieces_.count > 1) add_strays();
    std::sort(sites_.begin(), sites_.end(), [](const Site& a, const Site& b) { return a.lattice < b.lattice; });
    return std::move(sites_);
  }

 private:
  bool is_sound(int node) const { return raster_.damage[static_cast<Index>(node)] < request_.crack_damage; }
  bool is_taken(int node) const { return taken_[static_cast<Index>(lattice_.position(node))]; }
  int piece(int node) const { return pieces_.piece[static_cast<Index>(node)]; }

  bool is_border(int node) const {
    bool border = false;
    lattice_.for_each_link(node,
                           [&](int other) { border = border || !is_sound(other) || piece(other) != piece(node); });
    return border;
  }

  void add(const Site& site) {
    const Index at = static_cast<Index>(site.lattice);
    if (taken_[at]) return;
    taken_[at] = 1;
    owner_[at] = site.piece;
    sites_.push_back(site);
  }

  void add_node(int node, const Vec3& position, bool border) {
    add({position, piece(node), lattice_.position(node), node, border});
  }

  /// An anchor that is crack by now stays on its side: with the nearest island of those that were part of its region.
  void add_anchors() {
    std::map<int, Nearest> heirs;  // per old region: the nearest island node
    for (const Anchor& anchor : request_.anchors) {
      int side = piece(anchor.node);
      const int wanted = anchor.region;
      if (!is_sound(anchor.node) && request_.earlier_region[static_cast<Index>(side)] != wanted) {
        const auto entry = heirs.try_emplace(wanted);
        if (entry.second) entry.first->second = nearest_marked(lattice_, islands_from(wanted));
        const int source = entry.first->second.source[static_cast<Index>(lattice_.position(anchor.node))];
        if (source >= 0) side = piece(lattice_.node_at(source));
      }
      add({anchor.position, side, anchor.lattice, anchor.node, true});
    }
  }

  /// Marks of the positions of islands that were part of a region of the earlier extraction.
  std::vector<char> islands_from(int region) const {
    std::vector<char> marked(taken_.size(), 0);
    for (int node = 0; node < lattice_.count(); ++node)
      marked[static_cast<Index>(lattice_.position(node))] =
          pieces_.is_island[static_cast<Index>(node)] &&
          request_.earlier_region[static_cast<Index>(piece(node))] == region;
    return marked;
  }

  /// Along the gradient of the damage to where it reaches the value of a crack.
  void add_border(int node) {
    const Fit fit = linear_fit(raster_, node);
    const double steepness = fit.gradient.norm();
    if (!(steepness > 0)) return add_node(node, lattice_.point(node), true);
    const Vec3 normal = fit.gradient / steepness;
    const double move = std::clamp((request_.crack_damage - fit.value) / steepness, 0.0, farthest_move);
    const Vec3 position = lattice_.point(node) + lattice_.spacing() * move * normal;
    add_node(node, position, true);
    if (fit.outward.squaredNorm() > 0) add_ghosts(node, position, normal, fit.outward.normalized());
  }

  /// Outside the body the side of the crack goes on as it was, or the crack would turn before it meets the surface.
  void add_ghosts(int node, const Vec3& position, const Vec3& normal, const Vec3& outward) {
    const Vec3 along = outward - outward.dot(normal) * normal;
    if (!(along.norm() > 0.1)) return;  // the surface runs along the crack
    const Vec3 ghost = position + lattice_.spacing() * along.normalized();
    const int at = lattice_.nearest(ghost);
    if (lattice_.node_at(at) < 0) ghosts_.push_back({ghost, piece(node), at, node, true});
  }

  /// The lattice's levels of detail: every second position of a level along every axis makes the next.
  void add_fillers() {
    const Nearest nearest = nearest_marked(lattice_, taken_);
    for (int node = 0; node < lattice_.count(); ++node) {
      const int squared = nearest.squared[static_cast<Index>(lattice_.position(node))];
      if (squared == 0 || !is_sound(node)) continue;
      int step = 2;
      while (9 * step * step <= 4 * squared) step *= 2;
      const auto [i, j, k] = lattice_.coordinates(lattice_.position(node));
      if (i % step == 0 && j % step == 0 && k % step == 0) add_node(node, lattice_.point(node), false);
    }
  }

  void add_strays() {
    for (int round = 0; round < most_rounds; ++round) {
      const std::size_t before = sites_.size();
      add_sound_strays();
      add_crack_strays();
      if (sites_.size() == before) return;
    }
  }

  /// Sound nodes in another piece's cell.
  void add_sound_strays() {
    const Nearest nearest = nearest_marked(lattice_, taken_);
    for (int node = 0; node < lattice_.count(); ++node) {
      const Index source = static_cast<Index>(nearest.source[static_cast<Index>(lattice_.position(node))]);
      if (is_sound(node) && owner_[source] != piece(node)) add_node(node, lattice_.point(node), false);
    }
  }

  /// Crack nodes that a site on an island would claim across empty space, of the same piece or not: where it is of
  /// another, both sides of the crack need sites of their own.
  void add_crack_strays() {
    std::vector<char> islands(taken_.size(), 0);
    for (const Site& site : sites_)
      if (site.lattice == lattice_.position(site.node))
        islands[static_cast<Index>(site.lattice)] = pieces_.is_island[static_cast<Index>(site.node)];
    const Nearest nearest = nearest_marked(lattice_, islands);
    for (int node = 0; node < lattice_.count(); ++node) {
      const Index position = static_cast<Index>(lattice_.position(node));
      if (is_sound(node) || taken_[position] || nearest.source[position] < 0) continue;
      const double straight = std::sqrt(nearest.squared[position]);
      if (std::sqrt(pieces_.reach[static_cast<Index>(node)]) <= straight + slack) continue;
      add_node(node, lattice_.point(node), false);
    }
  }

  const Raster& raster_;
  const Lattice& lattice_;
  const Partition& pieces_;
  const SiteRequest& request_;
  std::vector<char> taken_;  // per position
  std::vector<int> owner_;   // per position: the piece of its site
  std::vector<Site> sites_, ghosts_;
};

}  // namespace

std::vector<Site> choose_sites(const Raster& raster, const Partition& pieces, const SiteRequest& request) {
  return Chooser(raster, pieces, request).run();
}

}  // namespace sunder::crack::detail
