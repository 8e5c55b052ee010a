/// Inspection flights: duration, shares by the three rules of visibility, distances and limits of a
/// planned flight, or of a flight of another program, around a cloud or a scene model.
///
///   inspection_benchmark (--cloud FILE | --scene NAME) [--flight FILE | --pattern orbit|rows]
///                        [--range M, 8] [--clearance M, 3] [--shares A B C, 0 0 0.98]
///                        [--views N, 1] [--min-height M] [--moves N, 60000] [--searches N, 1]
///                        [--seed N, 1] [--spacing M, range / 40] [--threads N, 1]
///
/// NAME is a model of sim/models/models.h, such as radcliffe-camera, whose surface is sampled at
/// the spacing. Clouds are used as they are. The camera is 75 degrees wide and 55 degrees high, the
/// pitch is between -85 and 70 degrees, and the limits are 2 m/s, 1 m/s^2, 0.5 m/s^3, 60 degrees/s
/// and 30 degrees/s^2: those of FC-Planner (ICRA 2024). --flight evaluates a flight instead of
/// planning one: t x y z yaw pitch per line. --pattern evaluates a pattern around the box of the
/// structure, at the same limits: circles that look at its axis, or rows along the four sides and
/// above the roof that look straight at them. Rows overlap by 30%.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/resource.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/flight_table.h"
#include "sim/models/models.h"
#include "survey/inspection/inspection_planner.h"

namespace {

using namespace skycap;
using namespace skycap::survey::inspection;
using geometry::degrees_per_radian;
using geometry::radians_per_degree;

struct Arguments {
  std::string cloud, scene, flight, pattern;
  double spacing = 0.0;
  std::optional<double> min_height;
  InspectionOptions options;
  InspectionRun run;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  arguments.options.searches = 1;
  arguments.options.goal.shares = {0.0, 0.0, 0.98};
  arguments.options.pitch = {-85.0 * radians_per_degree, 70.0 * radians_per_degree};
  for (int i = 1; i < count; ++i) {
    const std::string_view name = values[i];
    const auto text = [&] {
      if (i + 1 >= count) {
        std::fprintf(stderr, "%s requires a value\n", values[i]);
        std::exit(2);
      }
      return std::string(values[++i]);
    };
    const auto number = [&] { return std::atof(text().c_str()); };
    const auto whole = [&] { return static_cast<std::size_t>(number()); };
    InspectionOptions& options = arguments.options;
    if (name == "--cloud") {
      arguments.cloud = text();
    } else if (name == "--scene") {
      arguments.scene = text();
    } else if (name == "--flight") {
      arguments.flight = text();
    } else if (name == "--pattern") {
      arguments.pattern = text();
    } else if (name == "--range") {
      options.camera.range = number();
    } else if (name == "--clearance") {
      options.clearance = number();
    } else if (name == "--views") {
      options.goal.min_views = static_cast<int>(number());
    } else if (name == "--min-height") {
      arguments.min_height = number();
    } else if (name == "--moves") {
      options.moves = whole();
    } else if (name == "--searches") {
      options.searches = whole();
    } else if (name == "--seed") {
      arguments.run.seed = whole();
    } else if (name == "--spacing") {
      arguments.spacing = number();
    } else if (name == "--threads") {
      arguments.run.threads = static_cast<unsigned>(number());
    } else if (name == "--shares") {
      for (double& share : options.goal.shares) share = number();
    } else {
      std::fprintf(stderr, "unknown argument %s\n", values[i]);
      std::exit(2);
    }
  }
  return arguments;
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

InspectionSite make_site(const Arguments& arguments) {
  InspectionSite site;
  site.min_height = arguments.min_height;
  if (!arguments.cloud.empty()) {
    site.points = geometry::read_cloud(arguments.cloud).positions;
    return site;
  }
  const geometry::Mesh mesh = sim::builtin_model(
      arguments.scene, {.detail = sim::LevelOfDetail::coarse, .has_ground = false});
  const double spacing =
      arguments.spacing > 0.0 ? arguments.spacing : arguments.options.camera.range / 40.0;
  const auto count =
      static_cast<std::size_t>(geometry::surface_area(mesh) / (spacing * spacing)) + 100;
  const geometry::SurfaceSamples samples = geometry::sample_surface(mesh, count, 1);
  site.points = samples.points;
  site.normals = samples.normals;
  return site;
}

void print(const LimitUse& use, const char* name, const char* unit, double factor = 1.0) {
  std::printf("  %-16s %8.3f of %g %s, above in %.2f%% of the samples\n", name, factor * use.max,
              factor * use.limit, unit, 100.0 * use.share_above);
}

void print(const FlightEvaluation& evaluation) {
  std::printf("  duration         %8.1f s, %.1f m\n", evaluation.duration, evaluation.length);
  std::printf("  seen             pixel %zu (%.2f%%), solid %.2f%%, incidence %.2f%% of %zu\n",
              evaluation.seen[0], 100.0 * evaluation.share(0), 100.0 * evaluation.share(1),
              100.0 * evaluation.share(2), evaluation.points);
  std::printf("  views            mean %.1f, median %.0f, 10%% %.0f; nearest, median %.2f m\n",
              evaluation.views.mean, evaluation.views.median, evaluation.views.percentile_10,
              evaluation.median_view_distance);
  std::printf("  nearest          %.3f m, lowest z %.2f m\n", evaluation.nearest,
              evaluation.min_height);
  print(evaluation.speed, "speed", "m/s");
  print(evaluation.acceleration, "acceleration", "m/s^2");
  print(evaluation.jerk, "jerk", "m/s^3");
  print(evaluation.yaw_rate, "yaw rate", "degrees/s", degrees_per_radian);
  print(evaluation.yaw_acceleration, "yaw acceleration", "degrees/s^2", degrees_per_radian);
  print(evaluation.pitch_rate, "pitch rate", "degrees/s", degrees_per_radian);
  std::printf("  limits           %s\n", evaluation.keeps_limits() ? "kept" : "exceeded");
}

/// Prints the row of results pages.
void print_row(const Arguments& arguments, const std::string& flight,
               const FlightEvaluation& evaluation) {
  const std::string structure = arguments.cloud.empty() ? arguments.scene : arguments.cloud;
  const std::array flights{
      missions::inspection::ComparedFlight{structure, flight, evaluation, "", processor_seconds()}};
  std::printf("%s", missions::inspection::comparison_table(flights).c_str());
}

Vertex make_vertex(const Eigen::Vector3d& position, double yaw, double pitch) {
  Vertex vertex;
  vertex.position = position;
  vertex.yaw = std::remainder(yaw, 2.0 * std::numbers::pi);
  vertex.pitch = pitch;
  return vertex;
}

/// Returns the distance from the structure, and the distance between rows, of a pattern [m].
struct PatternSizes {
  explicit PatternSizes(const InspectionOptions& options)
      : standoff(0.5 * (options.clearance + options.camera.range)),
        rows(0.7 * 2.0 * standoff * std::tan(0.5 * options.camera.vertical_fov)) {}
  double standoff, rows;
};

/// Returns heights from `low` to `high` at equal distances of at most `step`.
std::vector<double> levels(double low, double high, double step) {
  const int count = std::max(1, static_cast<int>(std::ceil((high - low) / step)));
  std::vector<double> result;
  for (int i = 0; i <= count; ++i) result.push_back(low + (high - low) * i / count);
  return result;
}

std::vector<Vertex> orbit(const Eigen::AlignedBox3d& box, double low,
                          const InspectionOptions& options) {
  const PatternSizes sizes(options);
  const double radius = 0.5 * box.sizes().head<2>().norm() + sizes.standoff;
  std::vector<Vertex> vertices;
  constexpr int corners = 36;
  for (const double height : levels(low, box.max().z() + sizes.standoff, sizes.rows)) {
    const double pitch = height > box.max().z() ? -45.0 * radians_per_degree : 0.0;
    for (int i = 0; i <= corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      const Eigen::Vector3d at(box.center().x() + radius * std::cos(angle),
                               box.center().y() + radius * std::sin(angle), height);
      vertices.push_back(make_vertex(at, angle + std::numbers::pi, pitch));
    }
  }
  return vertices;
}

std::vector<Vertex> rows(const Eigen::AlignedBox3d& box, double low,
                         const InspectionOptions& options) {
  const PatternSizes sizes(options);
  const Eigen::Vector3d min = box.min().array() - sizes.standoff;
  const Eigen::Vector3d max = box.max().array() + sizes.standoff;
  const std::array<Eigen::Vector2d, 4> corners{
      Eigen::Vector2d(min.x(), min.y()), Eigen::Vector2d(max.x(), min.y()),
      Eigen::Vector2d(max.x(), max.y()), Eigen::Vector2d(min.x(), max.y())};
  std::vector<Vertex> vertices;
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const double yaw = 0.5 * std::numbers::pi * static_cast<double>(side + 1);
    bool is_forward = true;
    for (const double height : levels(low, box.max().z(), sizes.rows)) {
      for (const bool is_end : {!is_forward, is_forward}) {
        const Eigen::Vector2d& at = corners[(side + (is_end ? 1 : 0)) % corners.size()];
        vertices.push_back(make_vertex({at.x(), at.y(), height}, yaw, 0.0));
      }
      is_forward = !is_forward;
    }
  }
  bool is_forward = true;
  for (const double y : levels(box.min().y(), box.max().y(), sizes.rows)) {
    for (const bool is_end : {!is_forward, is_forward}) {
      vertices.push_back(make_vertex({is_end ? box.max().x() : box.min().x(), y, max.z()},
                                     0.5 * std::numbers::pi, options.pitch.min));
    }
    is_forward = !is_forward;
  }
  return vertices;
}

/// Returns the samples of a pattern around the structure.
std::vector<FlightSample> pattern_flight(const Arguments& arguments, const StructureCloud& cloud) {
  const Eigen::AlignedBox3d box = cloud.box();
  const double low = std::max(arguments.min_height.value_or(box.min().z()), box.min().z());
  const std::vector<Vertex> vertices = arguments.pattern == "orbit"
                                           ? orbit(box, low, arguments.options)
                                           : rows(box, low, arguments.options);
  return sample_flight(vertices, make_smoothing(arguments.options.limits), sample_interval);
}

void run(const Arguments& arguments) {
  const InspectionSite site = make_site(arguments);
  if (!arguments.flight.empty() || !arguments.pattern.empty()) {
    EvaluationOptions options;
    options.camera = arguments.options.camera;
    options.limits = arguments.options.limits;
    options.min_pitch = arguments.options.pitch.min;
    options.max_pitch = arguments.options.pitch.max;
    options.threads = arguments.run.threads;
    const StructureCloud cloud = make_structure_cloud(site.points, site.normals);
    const bool is_file = arguments.pattern.empty();
    const FlightEvaluation evaluation =
        evaluate_flight(is_file ? missions::inspection::read_flight_csv(arguments.flight)
                                : pattern_flight(arguments, cloud),
                        cloud, options);
    print(evaluation);
    std::printf("  processor        %8.1f s\n", processor_seconds());
    print_row(arguments, is_file ? arguments.flight : arguments.pattern, evaluation);
    return;
  }
  const InspectionPlan plan = plan_inspection(arguments.options, site, arguments.run);
  std::printf("  first tour       %8.1f s; %zu moves evaluated, %zu cells, %zu vertices; goal %s\n",
              plan.first_duration, plan.evaluated_moves, plan.cells, plan.vertices.size(),
              plan.meets_goal ? "met" : "missed");
  std::printf("  attainable       pixel %zu, solid %zu, incidence %zu\n", plan.attainable[0],
              plan.attainable[1], plan.attainable[2]);
  print(plan.evaluation);
  std::printf("  processor        %8.1f s\n", processor_seconds());
  print_row(arguments, "skycap, seed " + std::to_string(arguments.run.seed), plan.evaluation);
}

}  // namespace

int main(int count, char** values) {
  const Arguments arguments = parse(count, values);
  if (arguments.cloud.empty() == arguments.scene.empty()) {
    std::fprintf(stderr, "either --cloud or --scene is required\n");
    return 2;
  }
  try {
    run(arguments);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
