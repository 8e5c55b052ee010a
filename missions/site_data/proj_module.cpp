// Module with PROJ, loaded by reference_system.cpp on demand. Opening PROJ's database takes longer
// than most commands.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <proj.h>
#include <proj_experimental.h>

#include "geometry/error.h"
#include "missions/site_data/reference_system.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;

struct Destroy {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
  void operator()(PJ_OBJ_LIST* list) const { proj_list_destroy(list); }
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* factory) const {
    proj_operation_factory_context_destroy(factory);
  }
};
using ContextPtr = std::unique_ptr<PJ_CONTEXT, Destroy>;
using ObjectPtr = std::unique_ptr<PJ, Destroy>;

constexpr const char* ellipsoidal = "EPSG:4979";  // WGS84 with heights.
constexpr const char* surface = "EPSG:4326";      // WGS84 without heights.
constexpr const char* egm96 = "EPSG:4326+5773";

/// Maximum accuracy value of a substitute for the best operation [m].
constexpr double max_substitute_error = 5.0;

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorKind::bad_config, what); }

ContextPtr offline_context() {
  ContextPtr context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  if (proj_context_get_database_path(context.get()) == nullptr) {
    throw Error(ErrorKind::bad_file, "PROJ's database proj.db is not installed (proj-data)");
  }
  return context;
}

/// Coordinate operation and its properties according to PROJ.
struct Operation {
  ObjectPtr object;  ///< Axis order is east, north; units are degrees or metres.
  bool is_best = true;
  std::string missing;     ///< Missing grids of the best operation.
  double accuracy = -1.0;  ///< [m]; negative if unknown.
};

std::string stated(double accuracy) {
  if (!(accuracy >= 0.0)) return "no accuracy";
  std::string text = std::to_string(accuracy);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " m";
}

/// Search for operations for a site.
class OperationFinder {
 public:
  OperationFinder(PJ_CONTEXT* context, const std::optional<flight::GeodeticPoint>& near)
      : context_(context), near_(near) {}

  /// Returns the best operation with available grids, and whether it is the best of all. Returns an
  /// empty object if it does not exist.
  Operation find(const PJ* from, const char* target) const {
    const ObjectPtr to(proj_create(context_, target));
    const std::unique_ptr<PJ_OBJ_LIST, Destroy> list(
        proj_create_operations(context_, from, to.get(), factory().get()));
    Operation result;
    const int count = list ? proj_list_get_count(list.get()) : 0;
    for (int i = 0; i < count; ++i) {
      const ObjectPtr candidate(proj_list_get(context_, list.get(), i));
      if (proj_coordoperation_has_ballpark_transformation(context_, candidate.get()) != 0) continue;
      if (proj_coordoperation_is_instantiable(context_, candidate.get()) == 0) {
        if (result.is_best) result.missing = missing_grids(candidate.get());
        result.is_best = false;
        continue;
      }
      result.object.reset(proj_normalize_for_visualization(context_, candidate.get()));
      result.accuracy = proj_coordoperation_get_accuracy(context_, candidate.get());
      if (result.object) break;
    }
    return result;
  }

 private:
  std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, Destroy> factory() const {
    auto* const factory = proj_create_operation_factory_context(context_, nullptr);
    proj_operation_factory_context_set_spatial_criterion(
        context_, factory, PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
    proj_operation_factory_context_set_grid_availability_use(context_, factory,
                                                             PROJ_GRID_AVAILABILITY_IGNORED);
    proj_operation_factory_context_set_allow_ballpark_transformations(context_, factory, 0);
    if (near_) {
      // [degrees]; limits the area to the site instead of the country.
      constexpr double reach = 0.01;
      const auto wrapped = [](double longitude) { return std::remainder(longitude, 360.0); };
      proj_operation_factory_context_set_area_of_interest(
          context_, factory, wrapped(near_->longitude_deg - reach),
          std::max(-90.0, near_->latitude_deg - reach), wrapped(near_->longitude_deg + reach),
          std::min(90.0, near_->latitude_deg + reach));
    }
    return std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, Destroy>(factory);
  }

  std::string missing_grids(const PJ* operation) const {
    std::string names;
    const int count = proj_coordoperation_get_grid_used_count(context_, operation);
    for (int i = 0; i < count; ++i) {
      const char* name = nullptr;
      int available = 0;
      proj_coordoperation_get_grid_used(context_, operation, i, &name, nullptr, nullptr, nullptr,
                                        nullptr, nullptr, &available);
      if (available == 0 && name != nullptr)
        names += (names.empty() ? "" : ", ") + std::string(name);
    }
    return names.empty() ? "a grid" : names;
  }

  PJ_CONTEXT* context_;
  std::optional<flight::GeodeticPoint> near_;
};

/// Objects that a transformation uses during its lifetime.
struct Chain {
  ContextPtr context;
  bool is_latitude_first = false;
  bool has_heights = true;  ///< If false, z is ignored.
  ObjectPtr position;  ///< Conversion to longitude and latitude, and to height if `moves_height`.
  bool moves_height = false;
  double height_unit = 1.0;  ///< Unit in metres of heights that `position` does not convert.
  ObjectPtr height;          ///< Optional subsequent conversion from geoid to ellipsoidal heights.
  double added_height = 0.0;

  void apply(std::span<Vector3d> points) const;
};

void transform_all(PJ* operation, std::span<Vector3d> points, bool with_height) {
  if (points.empty()) return;
  constexpr std::size_t stride = sizeof(Vector3d);
  const std::size_t count = points.size(), heights = with_height ? count : 0;
  double* const x = points.data()->data();
  proj_trans_generic(operation, PJ_FWD, x, stride, count, x + 1, stride, count,
                     with_height ? x + 2 : nullptr, with_height ? stride : 0, heights, nullptr, 0,
                     0);
}

void Chain::apply(std::span<Vector3d> points) const {
  for (Vector3d& point : points) {
    if (is_latitude_first) std::swap(point.x(), point.y());
    if (!has_heights) point.z() = 0.0;
    if (!moves_height) point.z() *= height_unit;
  }
  transform_all(position.get(), points, moves_height);
  if (height) transform_all(height.get(), points, true);
  for (Vector3d& point : points) point.z() += added_height;
}

/// Reference system and its horizontal part.
struct System {
  ObjectPtr whole, horizontal;
  bool has_own_heights = false, is_compound = false, is_geographic = false;
  double unit = 1.0, height_unit = 1.0;  ///< Metres; 1 for degrees and without own heights.
};

/// Returns the unit of an axis in metres; 1 if the system has no such axis.
double read_axis_unit(PJ_CONTEXT* context, const PJ* system, int axis) {
  const ObjectPtr axes(proj_crs_get_coordinate_system(context, system));
  double unit = 1.0;
  proj_cs_get_axis_info(context, axes.get(), axis, nullptr, nullptr, nullptr, &unit, nullptr,
                        nullptr, nullptr);
  return unit;
}

/// Returns the source system of a bound CRS, or the system itself.
ObjectPtr unbound(PJ_CONTEXT* context, ObjectPtr system) {
  if (proj_get_type(system.get()) != PJ_TYPE_BOUND_CRS) return system;
  return ObjectPtr(proj_get_source_crs(context, system.get()));
}

System make_reference_system(PJ_CONTEXT* context, const std::string& crs) {
  const std::string quoted = "the coordinate reference system '" + crs.substr(0, 200) + "'";
  System system;
  system.whole.reset(proj_create(context, proj_name(crs).c_str()));
  const auto is_known = [&] { return system.whole && proj_is_crs(system.whole.get()) != 0; };
  const std::string by_numbers = is_known() ? std::string() : name_by_numbers(crs);
  if (!by_numbers.empty()) system.whole.reset(proj_create(context, by_numbers.c_str()));
  if (!is_known()) {
    const std::string likely = likely_name(crs);
    fail("PROJ does not know " + quoted + "; " +
         (likely.empty() ? std::string("set crs to its PROJ name")
                         : "set crs: " + likely + " if this system is intended"));
  }
  ObjectPtr plain = unbound(context, ObjectPtr(proj_clone(context, system.whole.get())));
  if (proj_get_type(plain.get()) == PJ_TYPE_COMPOUND_CRS) {
    const ObjectPtr vertical =
        unbound(context, ObjectPtr(proj_crs_get_sub_crs(context, plain.get(), 1)));
    system.horizontal.reset(proj_crs_get_sub_crs(context, plain.get(), 0));
    system.has_own_heights = system.is_compound = true;
    system.height_unit = read_axis_unit(context, vertical.get(), 0);
    plain = unbound(context, ObjectPtr(proj_clone(context, system.horizontal.get())));
  }
  const ObjectPtr axes(proj_crs_get_coordinate_system(context, plain.get()));
  const PJ_TYPE type = proj_get_type(plain.get());
  system.is_geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  if (!axes || (!system.is_geographic && type != PJ_TYPE_PROJECTED_CRS)) {
    fail(quoted + " has neither map coordinates nor longitude and latitude");
  }
  if (!system.horizontal) {
    system.has_own_heights = proj_cs_get_axis_count(context, axes.get()) == 3;
    if (system.has_own_heights) system.height_unit = read_axis_unit(context, plain.get(), 2);
    system.horizontal.reset(proj_crs_demote_to_2D(context, nullptr, system.whole.get()));
  }
  if (!system.is_geographic) system.unit = read_axis_unit(context, plain.get(), 0);
  return system;
}

std::string substitute(const char* standing, const std::string& what, const Operation& operation) {
  return std::string(standing) + " is used instead of " + what +
         "; accuracy according to PROJ: " + stated(operation.accuracy);
}

/// Applies the vertical datum `vertical` instead of that of the system.
void add_stated_heights(Chain& chain, const OperationFinder& finder,
                        const ReferenceRequest& request, GeodeticTransform& result) {
  if (*request.vertical == HeightDatum::takeoff) {
    if (!request.takeoff_height) fail("vertical: takeoff requires flight.takeoff");
    chain.added_height = *request.takeoff_height;
  }
  if (*request.vertical != HeightDatum::geoid) return;
  const ObjectPtr geoid(proj_create(chain.context.get(), egm96));
  Operation operation = finder.find(geoid.get(), ellipsoidal);
  if (!operation.object || !operation.is_best) {
    throw Error(ErrorKind::bad_file, "PROJ's EGM96 grid is not installed (proj-data)");
  }
  result.notes.push_back("heights above the geoid refer to EGM96; accuracy according to PROJ: " +
                         stated(operation.accuracy));
  result.substitution_error += std::max(0.0, operation.accuracy);
  chain.height = std::move(operation.object);
}

/// Uses one operation for position and height in the system's own datum. Returns false if the best
/// operation is not available and EGM96 may be used instead.
bool uses_native_heights(Chain& chain, const OperationFinder& finder, const System& system,
                         const ReferenceRequest& request, GeodeticTransform& result) {
  Operation operation = finder.find(system.whole.get(), ellipsoidal);
  if (!operation.object || !operation.is_best) {
    if (request.vertical) return false;
    fail("PROJ cannot transform " + result.name + " to WGS84 with full accuracy" +
         (operation.missing.empty() ? "" : ": missing " + operation.missing) +
         "; install PROJ's grid with projsync (package proj-bin, grids of cdn.proj.org), or use "
         "EGM96 instead (key vertical: geoid; skycap site: --vertical geoid)");
  }
  chain.position = std::move(operation.object);
  chain.moves_height = true;
  return true;
}

void add_position(Chain& chain, const OperationFinder& finder, const System& system,
                  const ReferenceRequest& request, GeodeticTransform& result) {
  Operation operation = finder.find(system.horizontal.get(), surface);
  const bool is_close = operation.accuracy >= 0.0 && operation.accuracy <= max_substitute_error;
  if (!operation.object || !(operation.is_best || is_close || !request.near)) {
    fail("PROJ cannot transform " + result.name + " to WGS84 with full accuracy" +
         (operation.missing.empty() ? "" : ": missing " + operation.missing) +
         (operation.object
              ? "; the accuracy of the next best operation is " + stated(operation.accuracy)
              : ""));
  }
  if (!operation.is_best) {
    result.notes.push_back(substitute("the next best operation", operation.missing, operation));
    result.substitution_error += std::max(0.0, operation.accuracy);
  }
  chain.position = std::move(operation.object);
}

}  // namespace

extern "C" void skycap_geodetic_transform(const ReferenceRequest& given,
                                          GeodeticTransform& result) {
  auto chain = std::make_shared<Chain>();
  chain->context = offline_context();
  const System system = make_reference_system(chain->context.get(), given.crs);
  ReferenceRequest request = given;
  if (!system.has_own_heights && !request.vertical) request.vertical = given.vertical_if_silent;
  const OperationFinder finder(chain->context.get(), request.near);
  result.name = proj_get_name(system.whole.get());
  result.horizontal_unit = system.unit;
  result.is_geographic = system.is_geographic;
  result.has_own_heights = system.has_own_heights;
  result.is_compound = system.is_compound;
  result.height_unit = system.height_unit;
  chain->height_unit = system.height_unit;
  chain->is_latitude_first = request.is_latitude_first && system.is_geographic;
  chain->has_heights = request.needs_heights;
  const bool wants_own =
      request.needs_heights && system.has_own_heights &&
      (!request.vertical || (request.vertical == HeightDatum::geoid && system.is_compound));
  if (request.needs_heights && !system.has_own_heights && !request.vertical) {
    fail(result.name + " has no vertical datum; set vertical: ellipsoid, geoid or takeoff");
  }
  if (!wants_own || !uses_native_heights(*chain, finder, system, request, result)) {
    add_position(*chain, finder, system, request, result);
    if (request.needs_heights) add_stated_heights(*chain, finder, request, result);
  }
  result.apply = [chain](std::span<Vector3d> points) { chain->apply(points); };
}

extern "C" void skycap_egm96_undulation(double latitude_deg, double longitude_deg,
                                        double& undulation) {
  Chain chain;
  chain.context = offline_context();
  GeodeticTransform ignored;
  const OperationFinder finder(chain.context.get(), std::nullopt);
  ReferenceRequest request;
  request.vertical = HeightDatum::geoid;
  add_stated_heights(chain, finder, request, ignored);
  Vector3d geodetic(longitude_deg, latitude_deg, 0.0);
  transform_all(chain.height.get(), {&geodetic, 1}, true);
  undulation = geodetic.z();
  if (!std::isfinite(undulation)) {
    throw Error(ErrorKind::bad_file, "PROJ's EGM96 grid has no height at latitude " +
                                         std::to_string(latitude_deg) + ", longitude " +
                                         std::to_string(longitude_deg));
  }
}

}  // namespace skycap::missions::site_data
