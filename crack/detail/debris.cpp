#include "crack/detail/debris.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace sunder::crack::detail {

namespace {
using Index = std::size_t;
constexpr double smallest_cell = 2;  // spacings: smaller cells hold no node but their seed
constexpr std::uint64_t order_stream = 0xdeb215;
}  // namespace

int Crushed::squared_depth(const Lattice& lattice, int node) const {
  const Index position = static_cast<Index>(lattice.position(node));
  return to_sound.source[position] < 0 ? std::numeric_limits<int>::max() : to_sound.squared[position];
}

Crushed find_crushed(const Raster& raster, double crack_damage) {
  const Lattice& lattice = raster.lattice;
  Crushed result;
  std::vector<char> marked(static_cast<Index>(lattice.positions()), 0);
  for (int node = 0; node < lattice.count(); ++node) {
    result.sound.push_back(raster.damage[static_cast<Index>(node)] < crack_damage);
    marked[static_cast<Index>(lattice.position(node))] = result.sound.back();
  }
  result.to_sound = nearest_marked(lattice, marked);
  return result;
}

double lump_share(const Lattice& lattice, const Crushed& crushed, double depth) {
  long deep = 0;
  for (int node = 0; node < lattice.count(); ++node) deep += crushed.squared_depth(lattice, node) > depth * depth;
  return static_cast<double>(deep) / static_cast<double>(lattice.count());
}

std::vector<int> debris_seeds(const Lattice& lattice, const Crushed& crushed, double size, std::uint64_t seed) {
  size = std::max(size, smallest_cell);
  std::vector<int> candidates;
  for (int node = 0; node < lattice.count(); ++node)
    if (crushed.squared_depth(lattice, node) >= size * size / 4) candidates.push_back(node);
  std::sort(candidates.begin(), candidates.end(), [&](int a, int b) {
    const auto key = [&](int node) {
      return std::pair(random_word(seed, order_stream, static_cast<std::uint64_t>(node)), node);
    };
    return key(a) < key(b);
  });
  std::vector<char> taken(static_cast<Index>(lattice.count()), 0);
  const int reach = static_cast<int>(std::floor(size));
  std::vector<int> seeds;
  for (const int node : candidates) {
    if (taken[static_cast<Index>(node)]) continue;
    seeds.push_back(node);
    for (int k = -reach; k <= reach; ++k)
      for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i)
          if (const int other = lattice.node_beside(node, i, j, k); other >= 0 && i * i + j * j + k * k < size * size)
            taken[static_cast<Index>(other)] = 1;
  }
  return seeds;
}

}  // namespace sunder::crack::detail
