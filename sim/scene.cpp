#include "sim/scene.h"

#include <cmath>
#include <string>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "sim/scene_embree.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

int native_packet_width(RTCDevice device) {
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return 16;
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) return 8;
  return 4;
}

void throw_on_device_error(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error(ErrorKind::bad_geometry,
              error == RTC_ERROR_OUT_OF_MEMORY
                  ? "there is not enough memory to make the scene ready for ray casting; use a "
                    "mesh with fewer triangles"
                  : "Embree cannot build the scene: error " + std::to_string(error));
}

/// The mesh as Embree's buffers, in single precision around `centre`.
RTCGeometry make_geometry(RTCDevice device, const geometry::Mesh& mesh, const Vector3d& centre) {
  const RTCGeometry triangles = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (vertices != nullptr && indices != nullptr) {
    for (const Vector3d& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) {
        *vertices++ = static_cast<float>(vertex[axis] - centre[axis]);
      }
    }
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) *indices++ = vertex;
    }
    rtcCommitGeometry(triangles);
  }
  return triangles;
}

/// A ray in Embree's frame; `direction` is a unit vector.
RTCRay make_ray(const Vector3d& origin, const Vector3d& direction, double max_distance) {
  RTCRay ray = {};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(max_distance);
  ray.mask = ~0U;
  return ray;
}

bool is_hit(const RTCRayHit& query) { return query.hit.geomID != RTC_INVALID_GEOMETRY_ID; }

// Whether the ray has met a surface from the side that its normal points to.
bool is_front(const RTCRayHit& query) {
  const auto& [ray, hit] = query;
  return is_hit(query) && ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z < 0.0F;
}

}  // namespace

Scene::Scene(const geometry::Mesh& mesh, unsigned threads) : embree_(std::make_unique<Embree>()) {
  geometry::validate(mesh);
  const std::string config = "threads=" + std::to_string(geometry::thread_count(threads));
  embree_->device = rtcNewDevice(config.c_str());
  if (embree_->device == nullptr) throw_on_device_error(nullptr);
  embree_->packet_width = native_packet_width(embree_->device);
  embree_->centre = geometry::bounding_box(mesh).center();

  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree_->scene, RTC_BUILD_QUALITY_MEDIUM);
  const RTCGeometry geometry = make_geometry(embree_->device, mesh, embree_->centre);
  rtcAttachGeometry(embree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  throw_on_device_error(embree_->device);
  rtcCommitScene(embree_->scene);
  throw_on_device_error(embree_->device);
}

Scene::Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads)
    : Scene(mesh, threads) {
  if (reflectances.size() != mesh.triangles.size()) {
    throw Error(ErrorKind::bad_geometry, "there are " + std::to_string(reflectances.size()) +
                                             " reflectances for " +
                                             std::to_string(mesh.triangles.size()) + " triangles");
  }
  reflectances_.assign(reflectances.begin(), reflectances.end());
}

Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

std::optional<Hit> Scene::first_hit(const Vector3d& origin, const Vector3d& direction,
                                    double max_distance) const {
  const double length = direction.norm();
  RTCRayHit query = {};
  query.ray = make_ray(origin - embree_->centre, direction / length, max_distance * length);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &query);
  if (!is_front(query)) {  // perhaps it passed through a vertex: see scene_embree.h
    RTCRayHit turned = query;
    turn(turned.ray.dir_x, turned.ray.dir_y, turned.ray.dir_z);
    turned.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_->scene, &context, &turned);
    if (is_hit(turned)) query = turned;
  }
  if (!is_hit(query)) return std::nullopt;
  return Hit{query.ray.tfar / length, query.hit.primID,
             Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized()};
}

bool Scene::is_blocked(const Vector3d& from, const Vector3d& to) const {
  const double length = (to - from).norm();
  if (length == 0.0) return false;
  RTCRay ray = make_ray(from - embree_->centre, (to - from) / length, length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;  // Embree's mark for a hit
}

}  // namespace skycap::sim
