#include "output/detail/ray_scene.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include "core/error.h"

namespace sunder::output::detail {
namespace {

constexpr std::size_t kPacket = 8;
constexpr unsigned kOpaque = 1, kClear = 2;  // masks
// Rays start so far from what they leave: some rounding errors of single precision at a size of one.
constexpr float kNear = 2e-6f;

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(geometry::Triangle) == 3 * sizeof(unsigned));

void add_triangles(RTCDevice device, RTCScene scene, const std::vector<Vec3f>& vertices,
                   std::span<const geometry::Triangle> triangles, unsigned id, unsigned mask) {
  if (triangles.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* points =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), vertices.size());
  void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(geometry::Triangle), triangles.size());
  if (points && corners) {
    std::memcpy(points, vertices.data(), vertices.size() * sizeof(Vec3f));
    std::memcpy(corners, triangles.data(), triangles.size_bytes());
    rtcSetGeometryMask(geometry, mask);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
  }
  rtcReleaseGeometry(geometry);
}

/// Fills lane after lane; lanes without a ray stay off.
template <class Packet>
void load(Packet& packet, std::array<int, kPacket>& on, std::span<const Ray> rays, unsigned mask) {
  on.fill(0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    on[i] = -1;
    packet.org_x[i] = rays[i].origin.x();
    packet.org_y[i] = rays[i].origin.y();
    packet.org_z[i] = rays[i].origin.z();
    packet.dir_x[i] = rays[i].direction.x();
    packet.dir_y[i] = rays[i].direction.y();
    packet.dir_z[i] = rays[i].direction.z();
    packet.tnear[i] = kNear;
    packet.tfar[i] = rays[i].far;
    packet.time[i] = 0;
    packet.mask[i] = mask;
    packet.id[i] = packet.flags[i] = 0;
  }
}

}  // namespace

struct RayScene::Handles {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  unsigned opaque = 0;  // number of triangles

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

RayScene::RayScene(const Soup& soup) : handles_(std::make_unique<Handles>()) {
  const std::span triangles = soup.triangles;
  handles_->opaque = static_cast<unsigned>(soup.opaque);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
  add_triangles(handles_->device, handles_->scene, soup.vertices, triangles.first(soup.opaque), 0, kOpaque);
  add_triangles(handles_->device, handles_->scene, soup.vertices, triangles.subspan(soup.opaque), 1, kClear);
  // Which of two triangles at one distance is met depends on the order within the tree, and that on the threads.
  tbb::task_arena(1).execute([this] { rtcCommitScene(handles_->scene); });
  if (const RTCError error = rtcGetDeviceError(handles_->device); error != RTC_ERROR_NONE)
    throw Error(ErrorKind::internal,
                "the picture could not be prepared (Embree error " + std::to_string(static_cast<int>(error)) + ")");
}

RayScene::~RayScene() = default;

void RayScene::trace(std::span<const Ray> rays, std::span<Hit> hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    RTCRayHit8 packet;
    alignas(32) std::array<int, kPacket> on;
    load(packet.ray, on, rays.subspan(first, count), kOpaque | kClear);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(on.data(), handles_->scene, &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      Hit& hit = hits[first + i];
      hit = {};
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const unsigned before = packet.hit.geomID[i] == 0 ? 0 : handles_->opaque;
      hit = {packet.ray.tfar[i], static_cast<int>(before + packet.hit.primID[i]), packet.hit.u[i], packet.hit.v[i]};
    }
  }
}

void RayScene::blocked(std::span<const Ray> rays, Kind kind, std::span<std::uint8_t> answers) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    RTCRay8 packet;
    alignas(32) std::array<int, kPacket> on;
    load(packet, on, rays.subspan(first, count), kind == Kind::opaque ? kOpaque : kClear);
    rtcOccluded8(on.data(), handles_->scene, &context, &packet);
    for (std::size_t i = 0; i < count; ++i) answers[first + i] = packet.tfar[i] < 0;
  }
}

}  // namespace sunder::output::detail
