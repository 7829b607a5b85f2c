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
// Rays start so far from what they leave: some rounding errors of single precision at a size of one.
constexpr float kNear = 2e-6f;

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(geometry::Triangle) == 3 * sizeof(unsigned));

void check(RTCDevice device) {
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    throw Error(ErrorKind::internal,
                "the picture could not be prepared (Embree error " + std::to_string(static_cast<int>(error)) + ")");
}

/// Triangles of one kind. They have scenes of their own: a ray that asks for one kind passes the other for nothing.
class Tree {
 public:
  Tree(RTCDevice device, const std::vector<Vec3f>& vertices, std::span<const geometry::Triangle> triangles)
      : scene_(rtcNewScene(device)) {
    check(device);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    if (!triangles.empty()) add(device, vertices, triangles);
    // Which of two triangles at one distance is met depends on the order within the tree, and that on the threads.
    tbb::task_arena(1).execute([this] { rtcCommitScene(scene_); });
    check(device);
  }
  ~Tree() { rtcReleaseScene(scene_); }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  RTCScene scene() const { return scene_; }

 private:
  void add(RTCDevice device, const std::vector<Vec3f>& vertices, std::span<const geometry::Triangle> triangles) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* points =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), vertices.size());
    void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(geometry::Triangle), triangles.size());
    if (points && corners) {
      std::memcpy(points, vertices.data(), vertices.size() * sizeof(Vec3f));
      std::memcpy(corners, triangles.data(), triangles.size_bytes());
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
    }
    rtcReleaseGeometry(geometry);
  }

  RTCScene scene_;
};

/// Fills lane after lane; lanes without a ray stay off.
template <class Packet>
void load(Packet& packet, std::array<int, kPacket>& on, std::span<const Ray> rays) {
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
    packet.mask[i] = ~0u;
    packet.id[i] = packet.flags[i] = 0;
  }
}

}  // namespace

struct RayScene::Trees {
  explicit Trees(const Soup& soup)
      : count{soup.opaque, soup.triangles.size() - soup.opaque},
        opaque(device.get(), soup.vertices, std::span(soup.triangles).first(soup.opaque)),
        clear(device.get(), soup.vertices, std::span(soup.triangles).subspan(soup.opaque)) {}

  const Tree& of(Kind kind) const { return kind == Kind::opaque ? opaque : clear; }

  std::array<std::size_t, 2> count;  // of triangles, by kind
  std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)> device{rtcNewDevice(nullptr), &rtcReleaseDevice};
  Tree opaque, clear;
};

RayScene::RayScene(const Soup& soup) : trees_(std::make_unique<Trees>(soup)) {}

bool RayScene::has(Kind kind) const { return trees_->count[static_cast<std::size_t>(kind)] > 0; }

RayScene::~RayScene() = default;

void RayScene::trace(std::span<const Ray> rays, Kind kind, std::span<Hit> hits) const {
  const std::size_t before = kind == Kind::opaque ? 0 : trees_->count[0];
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    RTCRayHit8 packet;
    alignas(32) std::array<int, kPacket> on;
    load(packet.ray, on, rays.subspan(first, count));
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(on.data(), trees_->of(kind).scene(), &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      Hit& hit = hits[first + i];
      hit = {};
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
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
    load(packet, on, rays.subspan(first, count));
    rtcOccluded8(on.data(), trees_->of(kind).scene(), &context, &packet);
    for (std::size_t i = 0; i < count; ++i) answers[first + i] = packet.tfar[i] < 0;
  }
}

}  // namespace sunder::output::detail
