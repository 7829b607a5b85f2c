#include "geometry/attributes.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "geometry/detail/mean_value.h"
#include "geometry/surface_distance.h"

namespace sunder::geometry {
namespace {

constexpr double kUnknownTime = -1;
const Colour kWhite = Colour::Ones();
constexpr double kShortest = 1e-6;  // a mean of unit normals that says nothing of a direction
constexpr double kNearlyLevel = 0.9;  // planes whose normal is this upright have no useful direction upward

using Corners = std::array<Vec3, 3>;

[[noreturn]] void reject(const std::string& why) { throw Error(ErrorKind::mesh, why); }

Corners corners_of(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.faces[face];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

Vec3 normal_of(const Corners& x) { return (x[1] - x[0]).cross(x[2] - x[0]).normalized(); }

template <typename T>
std::array<T, 3> same(const T& value) {
  return {value, value, value};
}

// ---- On the body's surface --------------------------------------------------------------------------------------

/// Where a point lies in a triangle: the weights of its corners.
struct Place {
  std::array<double, 3> weight;
  int corner = -1;  // the point is this corner
};

Place place_in(const Corners& triangle, const Vec3& x) {
  for (int k = 0; k < 3; ++k) {
    if (x == triangle[k]) return {{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, k};
  }
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  Place place{};
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 area = (triangle[(k + 1) % 3] - x).cross(triangle[(k + 2) % 3] - x);
    // Rounding, or a level set, may put the point beside the triangle.
    place.weight[k] = std::max(0.0, normal.dot(area));
    sum += place.weight[k];
  }
  if (!(sum > 0)) return {{1, 0, 0}, 0};
  for (double& weight : place.weight) weight /= sum;
  return place;
}

template <typename T>
T interpolated(const std::array<T, 3>& values, const Place& place) {
  if (place.corner >= 0) return values[place.corner];
  // In this form equal values stay what they are.
  return values[0] + place.weight[1] * (values[1] - values[0]) + place.weight[2] * (values[2] - values[0]);
}

// Rounding must not take a colour out of [0, 1].
Colour colour_at(const std::array<Colour, 3>& colours, const Place& place) {
  const Colour low = colours[0].cwiseMin(colours[1]).cwiseMin(colours[2]);
  const Colour high = colours[0].cwiseMax(colours[1]).cwiseMax(colours[2]);
  return interpolated(colours, place).cwiseMax(low).cwiseMin(high);
}

// The mean of the times that are known; negative weights, from points beside a polygon, cannot make it leave their
// range.
template <typename Weights, typename Times>
double known_time(const Weights& weights, const Times& times) {
  double sum = 0, total = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (times[i] < 0 || weights[i] == 0) continue;
    sum += weights[i] * times[i];
    total += weights[i];
    low = std::min<double>(low, times[i]);
    high = std::max<double>(high, times[i]);
  }
  return total > 0 ? std::clamp(sum / total, low, high) : kUnknownTime;
}

// ---- On cracks --------------------------------------------------------------------------------------------------

Vec3 newell_normal(const RegionBoundary& regions, const RegionBoundary::Face& face) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < face.loop.size(); ++i) {
    const Vec3& a = regions.vertices[face.loop[0]];
    normal += (regions.vertices[face.loop[i]] - a).cross(regions.vertices[face.loop[i + 1]] - a);
  }
  return normal.normalized();
}

/// Coordinates in a plane.
struct Basis {
  Vec3 u, v;
  Uv operator()(const Vec3& x) const { return {u.dot(x), v.dot(x)}; }
};

Basis basis_of(const Vec3& normal) {
  const Vec3 up = std::abs(normal.y()) < kNearlyLevel ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 u = up.cross(normal).normalized();
  return {u, normal.cross(u)};
}

/// What the faces on one crack face have in common.
struct CrackFace {
  int index = -2;  // none yet
  Basis texture;
  Vec3 normal;  // outward
  Basis plane;  // in which `loop` is
  std::vector<Uv> loop;
  std::vector<double> time;  // of the loop's vertices
};

CrackFace crack_face(const RegionBoundary& regions, int index, int region, const InsideSettings& settings) {
  const RegionBoundary::Face& face = regions.faces[index];
  const Vec3 normal = newell_normal(regions, face);
  const Vec3 to_higher = settings.texture_normal.empty() ? normal : settings.texture_normal[index];
  CrackFace result{.index = index,
                   .texture = basis_of(face.inside < face.outside ? to_higher : Vec3(-to_higher)),
                   .normal = region == face.inside ? normal : Vec3(-normal),
                   .plane = basis_of(normal),
                   .loop = {},
                   .time = {}};
  if (settings.damage_time.empty()) return result;
  for (const int vertex : face.loop) {
    result.loop.push_back(result.plane(regions.vertices[vertex]));
    result.time.push_back(settings.damage_time[vertex]);
  }
  return result;
}

// For a face that belongs to no crack face.
CrackFace lone_face(const Corners& x) {
  CrackFace result;
  result.index = -1;
  result.normal = normal_of(x);
  int axis = 0;
  result.normal.cwiseAbs().maxCoeff(&axis);
  result.texture = basis_of(Vec3::Unit(axis));
  return result;
}

double time_at(const CrackFace& face, const Vec3& x) {
  if (face.loop.empty()) return kUnknownTime;
  return known_time(detail::mean_value_weights(face.loop, face.plane(x)), face.time);
}

// ---- Both -------------------------------------------------------------------------------------------------------

/// Which attributes the fragment has, and its materials.
struct Plan {
  bool uv, normal, material, colour, damage_time;
  std::vector<std::string> names;
  int inside_material;
};

Plan plan_for(const SurfaceAttributes& of_body, bool any_inside, const InsideSettings& settings) {
  Plan plan{!of_body.uv.empty() || (any_inside && settings.uv),
            !of_body.normal.empty() || (any_inside && settings.normal),
            !of_body.material.empty() || any_inside,
            !of_body.colour.empty(),
            !of_body.damage_time.empty() || (any_inside && !settings.damage_time.empty()),
            of_body.material_names,
            -1};
  if (!any_inside) return plan;
  if (of_body.material.empty()) plan.names = {"outside"};
  const auto found = std::find(plan.names.begin(), plan.names.end(), settings.material);
  plan.inside_material = static_cast<int>(found - plan.names.begin());
  if (found == plan.names.end()) plan.names.push_back(settings.material);
  return plan;
}

/// Appends the attributes of one face after the other.
class Builder {
 public:
  Builder(const SurfaceAttributes& of_body, const Plan& plan) : of_body_(of_body), plan_(plan) {
    result_.material_names = plan.names;
  }

  void add_outside(const Corners& x, const Corners& source_corners, int source) {
    std::array<Place, 3> place;
    for (int k = 0; k < 3; ++k) place[k] = place_in(source_corners, x[k]);
    if (plan_.uv) {
      result_.uv.push_back(same<Uv>(Uv::Zero()));
      for (int k = 0; k < 3 && !of_body_.uv.empty(); ++k) {
        result_.uv.back()[k] = interpolated(of_body_.uv[source], place[k]);
      }
    }
    if (plan_.normal) {
      result_.normal.push_back(same(normal_of(source_corners)));
      for (int k = 0; k < 3 && !of_body_.normal.empty(); ++k) {
        const Vec3 normal = interpolated(of_body_.normal[source], place[k]);
        if (normal.norm() < kShortest) continue;  // between opposite normals: the face's
        result_.normal.back()[k] = place[k].corner >= 0 ? normal : normal.normalized();
      }
    }
    if (plan_.material) result_.material.push_back(of_body_.material.empty() ? 0 : of_body_.material[source]);
    if (plan_.colour) {
      const std::array<Colour, 3>& colours = of_body_.colour[source];
      result_.colour.push_back(
          {colour_at(colours, place[0]), colour_at(colours, place[1]), colour_at(colours, place[2])});
    }
    if (plan_.damage_time) {
      result_.damage_time.push_back(same(kUnknownTime));
      for (int k = 0; k < 3 && !of_body_.damage_time.empty(); ++k) {
        const std::array<double, 3>& times = of_body_.damage_time[source];
        result_.damage_time.back()[k] =
            place[k].corner >= 0 ? times[place[k].corner] : known_time(place[k].weight, times);
      }
    }
  }

  void add_inside(const Corners& x, const CrackFace& face) {
    if (plan_.uv) result_.uv.push_back({face.texture(x[0]), face.texture(x[1]), face.texture(x[2])});
    if (plan_.normal) result_.normal.push_back(same(face.normal));
    if (plan_.material) result_.material.push_back(plan_.inside_material);
    if (plan_.colour) result_.colour.push_back(same(kWhite));
    if (plan_.damage_time) {
      result_.damage_time.push_back({time_at(face, x[0]), time_at(face, x[1]), time_at(face, x[2])});
    }
  }

  /// A face that the body has nothing for.
  void add_bare(const Corners& x, int material) {
    if (plan_.uv) result_.uv.push_back(same<Uv>(Uv::Zero()));
    if (plan_.normal) result_.normal.push_back(same(normal_of(x)));
    if (plan_.material) result_.material.push_back(material);
    if (plan_.colour) result_.colour.push_back(same(kWhite));
    if (plan_.damage_time) result_.damage_time.push_back(same(kUnknownTime));
  }

  SurfaceAttributes take() { return std::move(result_); }

 private:
  const SurfaceAttributes& of_body_;
  const Plan& plan_;
  SurfaceAttributes result_;
};

void require_fitting(const TriangleMesh& body, const SurfaceAttributes& of_body, const Fragment& fragment,
                     const RegionBoundary& regions, const InsideSettings& settings) {
  const auto fit = [](std::size_t size, std::size_t wanted) { return size == 0 || size == wanted; };
  if (!fits(of_body, body)) reject("the attributes do not fit the body");
  if (!fit(settings.texture_normal.size(), regions.faces.size())) reject("texture normals do not fit the regions");
  if (!fit(settings.damage_time.size(), regions.vertices.size())) reject("damage times do not fit the regions");
  const auto below = [](const std::vector<int>& indices, std::size_t count) {
    return std::all_of(indices.begin(), indices.end(), [&](int i) { return i < static_cast<int>(count); });
  };
  const std::size_t faces = fragment.mesh.faces.size();
  if (fragment.source_face.size() != faces || fragment.crack_face.size() != faces ||
      !below(fragment.source_face, body.faces.size()) || !below(fragment.crack_face, regions.faces.size())) {
    reject("the fragment is not one of this body and these regions");
  }
}

}  // namespace

bool fits(const SurfaceAttributes& attributes, const TriangleMesh& mesh) {
  const auto fit = [&](std::size_t size) { return size == 0 || size == mesh.faces.size(); };
  const int names = static_cast<int>(attributes.material_names.size());
  const auto named = [&](int material) { return material >= 0 && material < names; };
  return fit(attributes.uv.size()) && fit(attributes.normal.size()) && fit(attributes.material.size()) &&
         fit(attributes.colour.size()) && fit(attributes.damage_time.size()) &&
         std::all_of(attributes.material.begin(), attributes.material.end(), named);
}

std::vector<Vec3> face_normals(const RegionBoundary& regions) {
  std::vector<Vec3> normals;
  for (const RegionBoundary::Face& face : regions.faces) normals.push_back(newell_normal(regions, face));
  return normals;
}

SurfaceAttributes carry(const TriangleMesh& body, const SurfaceAttributes& of_body, const Fragment& fragment,
                        const RegionBoundary& regions, const InsideSettings& settings) {
  require_fitting(body, of_body, fragment, regions, settings);
  const bool any_inside =
      std::any_of(fragment.source_face.begin(), fragment.source_face.end(), [](int source) { return source < 0; });
  const Plan plan = plan_for(of_body, any_inside, settings);
  Builder builder(of_body, plan);
  CrackFace crack;
  for (int i = 0; i < static_cast<int>(fragment.mesh.faces.size()); ++i) {
    const Corners x = corners_of(fragment.mesh, i);
    if (fragment.source_face[i] >= 0) {
      builder.add_outside(x, corners_of(body, fragment.source_face[i]), fragment.source_face[i]);
      continue;
    }
    const int index = fragment.crack_face[i];
    if (index < 0) crack = lone_face(x);
    if (index >= 0 && index != crack.index) crack = crack_face(regions, index, fragment.region, settings);
    builder.add_inside(x, crack);
  }
  return builder.take();
}

SurfaceAttributes transferred(const TriangleMesh& source, const SurfaceAttributes& attributes,
                              const TriangleMesh& target, double reach) {
  if (!fits(attributes, source)) reject("the attributes do not fit the mesh");
  std::vector<Vec3> centres;
  for (int i = 0; i < static_cast<int>(target.faces.size()); ++i) {
    const Corners x = corners_of(target, i);
    centres.push_back((x[0] + x[1] + x[2]) / 3);
  }
  const Plan plan = plan_for(attributes, false, {});
  Builder builder(attributes, plan);
  const std::vector<SurfacePoint> nearest = nearest_on(source, centres);
  for (int i = 0; i < static_cast<int>(target.faces.size()); ++i) {
    const int face = nearest[i].face;
    if (nearest[i].distance <= reach)
      builder.add_outside(corners_of(target, i), corners_of(source, face), face);
    else
      builder.add_bare(corners_of(target, i), attributes.material.empty() ? 0 : attributes.material[face]);
  }
  return builder.take();
}

void transform_normals(SurfaceAttributes& attributes, const Mat3& linear) {
  const Mat3 of_normals = linear.inverse().transpose();
  for (std::array<Vec3, 3>& normals : attributes.normal)
    for (Vec3& normal : normals) normal = (of_normals * normal).normalized();
}

}  // namespace sunder::geometry
