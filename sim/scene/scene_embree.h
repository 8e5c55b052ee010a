/// What Scene hides: the Embree objects, and the packets in which all sensors cast their rays.
/// For sources of this folder only.
///
/// Embree's robust mode has no gaps along edges, but of rays aimed exactly at a vertex about one in
/// a thousand passes between the triangles that share it: rounding puts it on the outer side of
/// every one. A ray that does so misses, or meets another surface from behind, while its neighbours
/// meet a front. Such rays are therefore cast once more, turned by two millionths of a radian, and
/// the nearer hit counts. Where a surface really ends this costs a second cast and changes nothing.
///
/// A packet is `width` rays that Embree takes through the tree together: 16 with AVX-512, 8 with
/// AVX, 4 with SSE or NEON. With the coherent flag a packet costs little more than a single ray as
/// long as its rays visit the same nodes, so callers fill it with neighbours.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <embree3/rtcore.h>

#include "sim/scene/four_lanes.h"
#include "sim/scene/scene.h"

namespace skycap::sim {

/// One copy of a part of the scene: an instance of Embree's, by whose number it is found.
struct SceneCopy {
  Eigen::Matrix3f rotation;      ///< world from mesh
  std::uint32_t first_triangle;  ///< number of its first triangle among those of all copies
  std::uint32_t own_triangle;    ///< the same among those of all parts
};

struct Scene::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<SceneCopy> copies;  ///< none: the scene is a single mesh, not instanced
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< world position of Embree's origin
  int packet_width = 4;  ///< the widest packets that this processor casts natively: 4, 8 or 16

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

/// Turns a ray a little, as the comment above says, in a direction that few rays have.
inline void turn(float& x, float& y, float& z) {
  const float step = 1e-6F * (std::abs(x) + std::abs(y) + std::abs(z));
  x += 1.1F * step;
  y -= 1.3F * step;
  z += 0.9F * step;
}

/// What Embree says of a hit on a copy, in the mesh's own frame, as a hit in the world.
inline void take_to_world(const SceneCopy& copy, float& normal_x, float& normal_y, float& normal_z,
                          unsigned& triangle) {
  const Eigen::Vector3f normal = copy.rotation * Eigen::Vector3f(normal_x, normal_y, normal_z);
  normal_x = normal.x();
  normal_y = normal.y();
  normal_z = normal.z();
  triangle += copy.first_triangle;
}

template <int width>
struct PacketTypes;
template <>
struct PacketTypes<4> {
  using RayHit = RTCRayHit4;
  static constexpr auto intersect = rtcIntersect4;
};
template <>
struct PacketTypes<8> {
  using RayHit = RTCRayHit8;
  static constexpr auto intersect = rtcIntersect8;
};
template <>
struct PacketTypes<16> {
  using RayHit = RTCRayHit16;
  static constexpr auto intersect = rtcIntersect16;
};

/// Rays being cast. Fill `rays.ray`'s origins and directions, call cast(), read `rays`.
template <int width>
class Packet {
 public:
  using Lanes = Eigen::Map<Eigen::Array<float, width, 1>, Eigen::Aligned16>;

  typename PacketTypes<width>::RayHit rays;
  alignas(64) int active[width];  ///< -1 to cast a lane, 0 to leave it out

  Packet() {
    rtcInitIntersectContext(&context_);
    context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (int lane = 0; lane < width; ++lane) {
      active[lane] = -1;
      rays.ray.tnear[lane] = 0.0F;
      rays.ray.time[lane] = 0.0F;
      rays.ray.mask[lane] = ~0U;
      rays.ray.id[lane] = 0;
      rays.ray.flags[lane] = 0;
      rays.hit.Ng_x[lane] = rays.hit.Ng_y[lane] = rays.hit.Ng_z[lane] = 0.0F;
      rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  /// Finds the first hit of every active lane at a distance of at most `reach` direction lengths.
  void cast(const Scene::Embree& embree, float reach) {
    for (int lane = 0; lane < width; ++lane) {
      rays.ray.tfar[lane] = reach;
      rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect(embree, active, rays);
    FourInts front_lanes = ~FourInts{};
    for (int lane = 0; lane < width; lane += 4) front_lanes &= is_front_4(lane);
    if (sum(front_lanes) != -4) mend(embree);
  }

  bool is_hit(int lane) const { return rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
  FourInts is_hit_4(int first_lane) const {
    return four<FourInts>(rays.hit.geomID + first_lane) !=
           static_cast<int>(RTC_INVALID_GEOMETRY_ID);
  }

 private:
  // Hits become those of one mesh in the world, whatever copies the scene is made of.
  void intersect(const Scene::Embree& embree, const int* lanes,
                 typename PacketTypes<width>::RayHit& query) {
    PacketTypes<width>::intersect(lanes, embree.scene, &context_, &query);
    if (embree.copies.empty()) return;
    auto& hit = query.hit;
    for (int lane = 0; lane < width; ++lane) {
      if (lanes[lane] == 0 || hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const SceneCopy& copy = embree.copies[hit.instID[0][lane]];
      take_to_world(copy, hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane], hit.primID[lane]);
    }
  }

  // Whether lanes have met a surface from the side that its normal points to.
  FourInts is_front_4(int first_lane) const {
    const auto& [ray, hit] = rays;
    const auto lanes = [&](const float* values) { return four<FourFloats>(values + first_lane); };
    const FourFloats cosine = lanes(ray.dir_x) * lanes(hit.Ng_x) +
                              lanes(ray.dir_y) * lanes(hit.Ng_y) +
                              lanes(ray.dir_z) * lanes(hit.Ng_z);
    return is_hit_4(first_lane) & (cosine < 0.0F);
  }

  // Casts again the lanes that may have passed through a vertex: those without a front where others
  // have one, or else those without a hit.
  [[gnu::noinline]] void mend(const Scene::Embree& embree) {
    bool some_front = false, some_hit = false;
    for (int lane = 0; lane < width; lane += 4) {
      some_front |= sum(is_front_4(lane)) != 0;
      some_hit |= sum(is_hit_4(lane)) != 0;
    }
    if (!some_hit) return;

    alignas(64) int suspicious[width];
    FourInts any = {};
    for (int lane = 0; lane < width; lane += 4) {
      const FourInts is_settled = is_front_4(lane) | (some_front ? FourInts{} : is_hit_4(lane));
      const FourInts lanes = ~is_settled & four<FourInts>(active + lane);
      put_four(suspicious + lane, lanes);
      any |= lanes;
    }
    if (sum(any) == 0) return;

    auto turned = rays;
    for (int lane = 0; lane < width; ++lane) {
      turn(turned.ray.dir_x[lane], turned.ray.dir_y[lane], turned.ray.dir_z[lane]);
      turned.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect(embree, suspicious, turned);
    for (int lane = 0; lane < width; ++lane) {
      if (suspicious[lane] == 0 || turned.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      rays.ray.tfar[lane] = turned.ray.tfar[lane];  // the cast did not look farther than the first
      rays.hit.geomID[lane] = turned.hit.geomID[lane];
      rays.hit.primID[lane] = turned.hit.primID[lane];
      rays.hit.Ng_x[lane] = turned.hit.Ng_x[lane];
      rays.hit.Ng_y[lane] = turned.hit.Ng_y[lane];
      rays.hit.Ng_z[lane] = turned.hit.Ng_z[lane];
    }
  }

  RTCIntersectContext context_;
};

/// Calls `work` with the packet width to use as its template argument.
template <typename Work>
void with_packet_width(const Scene::Embree& embree, Work&& work) {
  switch (embree.packet_width) {
    case 16:
      return work.template operator()<16>();
    case 8:
      return work.template operator()<8>();
    default:
      return work.template operator()<4>();
  }
}

}  // namespace skycap::sim
