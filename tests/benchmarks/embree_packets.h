/// Reference for Skycap's ray casting: Embree in its fastest configuration without gaps along
/// edges.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>
#include <embree3/rtcore.h>

#include "geometry/parallel.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::benchmarks {

/// Mesh in an Embree scene, translated so that the centre of its bounding box is the origin.
class EmbreeMesh {
 public:
  EmbreeMesh(const geometry::Mesh& mesh, unsigned threads)
      : centre(geometry::bounding_box(mesh).center()) {
    const std::string config = "threads=" + std::to_string(geometry::thread_count(threads));
    device_ = rtcNewDevice(config.c_str());
    scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) {
        *vertices++ = static_cast<float>(vertex[axis] - centre[axis]);
      }
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) *indices++ = vertex;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;
  ~EmbreeMesh() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device_);
  }

  /// Returns the largest packet width that this processor supports natively.
  int packet_width() const {
    if (rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return 16;
    if (rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) return 8;
    return 4;
  }
  /// Calls `work` with packet_width() as its template argument.
  template <typename Work>
  void with_packet_width(Work&& work) const {
    const int width = packet_width();
    if (width == 16) return work.template operator()<16>();
    if (width == 8) return work.template operator()<8>();
    work.template operator()<4>();
  }

  Eigen::Vector3d centre;
  RTCScene scene = nullptr;

 private:
  RTCDevice device_ = nullptr;
};

template <int width>
struct EmbreePacketTypes;
template <>
struct EmbreePacketTypes<4> {
  using RayHit = RTCRayHit4;
  static constexpr auto intersect = rtcIntersect4;
};
template <>
struct EmbreePacketTypes<8> {
  using RayHit = RTCRayHit8;
  static constexpr auto intersect = rtcIntersect8;
};
template <>
struct EmbreePacketTypes<16> {
  using RayHit = RTCRayHit16;
  static constexpr auto intersect = rtcIntersect16;
};

/// Packet of rays: set the origins and directions in `rays.ray`, call cast(), then read
/// `rays.ray.tfar`.
template <int width>
class EmbreePacket {
 public:
  typename EmbreePacketTypes<width>::RayHit rays;

  EmbreePacket() {
    rtcInitIntersectContext(&context_);
    context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (int lane = 0; lane < width; ++lane) {
      active_[lane] = -1;
      rays.ray.tnear[lane] = 0.0F;
      rays.ray.time[lane] = 0.0F;
      rays.ray.mask[lane] = ~0U;
      rays.ray.id[lane] = 0;
      rays.ray.flags[lane] = 0;
      rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  void cast(const EmbreeMesh& mesh, float reach) {
    for (int lane = 0; lane < width; ++lane) {
      rays.ray.tfar[lane] = reach;
      rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    EmbreePacketTypes<width>::intersect(active_, mesh.scene, &context_, &rays);
  }

 private:
  alignas(64) int active_[width];
  RTCIntersectContext context_;
};

}  // namespace skycap::benchmarks
