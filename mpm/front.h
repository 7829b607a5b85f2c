#pragma once
/// Crack-front rules: a crack is a surface with a front of finite speed. A purely local strength criterion knows
/// neither, and where the grid is much coarser than the material's process zone it turns the whole overstressed region
/// to powder.
#include <span>
#include <vector>

#include "core/types.h"
#include "mpm/material_bins.h"
#include "mpm/solve.h"

namespace sunder::mpm {

/// A virgin particle whose largest principal stress exceeds the propagation strength.
struct Candidate {
  int particle = 0;
  Vec3 position = Vec3::Zero();  ///< material [m]
  Vec3 normal = Vec3::UnitX();   ///< direction of the largest principal stress
  double stress = 0;             ///< that stress [Pa]
  double urgency = 0;            ///< stress / nucleation strength
};

/// What a candidate is to become.
enum class Verdict {
  wait,      ///< shielded by a crack beside it, or the front ahead of which it lies has not had the time to reach it
  filler,    ///< starts at the propagation strength as part of the band of an existing crack
  advance,   ///< starts at the propagation strength as the new front of an existing crack
  nucleate,  ///< nothing near: a new crack if the stress exceeds the nucleation strength
};

/// The front particles so far, binned in material space.
class CrackFronts {
 public:
  /// `domain`: material box of all particles; `cell_size` h [m]; `p_wave_speed` [m/s].
  CrackFronts(const Box& domain, double cell_size, double p_wave_speed, const FrontSettings& settings);

  /// What the fronts with sequence number >= `first` say about a candidate. Rules, with a the distance off the front
  /// particle's crack plane and b the distance along it, for fronts within R_s whose normals are parallel enough:
  /// beside (a > b tan(ahead)): a <= w_b and b <= h fills, a > w_b shields; ahead within reach: advances once t - t_q
  /// >= distance / speed. Only what the verdict needs is looked up.
  struct Sight {
    bool fills = false, shields = false, ahead = false, early = false;
    int shielder = -1;  ///< a front that shields, by sequence number
    Sight operator|(const Sight& o) const {
      return {fills || o.fills, shields || o.shields, ahead || o.ahead, early || o.early,
              std::max(shielder, o.shielder)};
    }
    /// Filler before shield before ahead before early: a crack fills its band first, and never grows a neighbour.
    Verdict verdict() const;
  };
  Sight look(const Vec3& position, const Vec3& normal, double time, int first = 0) const;

  /// What is known of a candidate from earlier looks, to be quicker.
  struct Hint {
    bool far = false;   ///< no front is so near that it could do more than shield
    int shielder = -1;  ///< a front that shielded before
  };
  Sight look(const Vec3& position, const Vec3& normal, double time, const Hint& hint) const;

  /// Within this distance a front can do more than shield [m]; and whether one would, were its normal parallel enough.
  double near_distance() const { return near_; }
  bool reaches(const Vec3& front, const Vec3& front_normal, const Vec3& position) const;

  void add(const Vec3& position, const Vec3& normal, double time);
  int count() const { return static_cast<int>(all_.size()); }

 private:
  struct Front {
    Vec3 position, normal;
    double time;
    int number;
  };
  using Query = Front;
  enum class Place { away, in_band, beside, ahead };
  /// Where a point stands that is `d` away from a front.
  Place place(const Vec3& d, const Vec3& front_normal) const;
  /// What one front says; nothing unless it is within R_s and parallel enough.
  Sight sight_of(const Front& front, const Query& query) const;
  /// Adds what the fronts of a list say; true as soon as that is enough.
  template <class Enough>
  bool scan_list(std::span<const Front> fronts, const Query& query, const Enough& enough, Sight& sight) const;
  /// What the fronts in the bins within `distance` say, until that is enough.
  template <class Enough>
  Sight scan(const Query& query, double distance, const Enough& enough) const;

  double radius_, cell_size_, filler_width_, reach_, near_, speed_, tan_ahead_, cos_parallel_;
  MaterialBins<std::vector<Front>> bins_;
  std::vector<Front> all_;  ///< by sequence number
};

}  // namespace sunder::mpm
