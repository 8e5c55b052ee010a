#include "sim/models/city_block.h"

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "sim/models/city_buildings.h"
#include "sim/models/masonry/tree.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double half_side = 98.0;    // Half side of the built-up square [m].
constexpr double half_street = 11.0;  // Distance from the street axis to the building line [m].
constexpr double half_carriageway = 4.5;
constexpr double front_depth = 40.0;  // Depth of the lots on the street [m].
constexpr double lane = 9.0;          // Distance between the rows of lots [m].
constexpr double gap = 5.0;           // Distance between neighbouring buildings [m].

using Kind = Parts (*)(const city::Lot&, RandomNumbers&, const Fineness&);

/// City block under construction.
class Block {
 public:
  explicit Block(const CityBlockOptions& options)
      : fineness_(options.fineness), draw_(options.seed) {}

  void build_rows() {
    // One row of fronts contains the tower, the other the arcade. The back buildings are of random
    // types, but one in each row is a courtyard house.
    const double back_depth = half_side - half_street - front_depth - lane;
    const double front_middle = half_street + 0.5 * front_depth;
    const double back_middle = half_side - 0.5 * back_depth;
    build_row(front_middle, front_depth, draw_.integer(3, 4), city::tower_hall, pi);
    build_row(-front_middle, front_depth, draw_.integer(3, 4), city::arcade_house, 0.0);
    build_row(back_middle, back_depth, draw_.integer(2, 4), city::courtyard_house, 0.0);
    build_row(-back_middle, back_depth, draw_.integer(2, 4), city::courtyard_house, pi);
  }

  void pave_street() {
    for (const double side : {-1.0, 1.0}) {
      const double inner = side * half_carriageway, outer = side * (half_street - 2.5);
      parts_.push_back({"pavement", box({-half_side, std::min(inner, outer), 0.0},
                                        {half_side, std::max(inner, outer), 0.14})});
    }
  }

  void plant_trees() {
    for (const double side : {-1.0, 1.0}) {
      for (double x = -half_side + 8.0; x < half_side - 6.0; x += draw_.between(13.0, 19.0)) {
        // Trees are near the kerb, because they would block the walk in front of the arcade.
        plant(draw_.between(6.0, 9.0), {x, side * (half_carriageway + 1.0), 0.1});
      }
      const double lane_middle = half_street + front_depth + 0.5 * lane;
      for (double x = -half_side + 10.0; x < half_side - 8.0; x += draw_.between(20.0, 34.0)) {
        plant(draw_.between(5.0, 8.0), {x, side * lane_middle, 0.0});
      }
    }
  }

  Parts result() { return std::move(parts_); }

 private:
  /// Adds `count` buildings along x at y = `middle`, with fronts rotated by `azimuth`. A random one
  /// has the row's own `kind`.
  void build_row(double middle, double depth, int count, Kind kind, double azimuth) {
    const int special = draw_.integer(0, count - 1);
    // Fractions of the row. No lot is less than half as wide as another.
    std::vector<double> shares;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += shares.emplace_back(draw_.between(1.0, 1.7));
    double x = -half_side;
    for (int i = 0; i < count; ++i) {
      const double width = 2.0 * half_side * shares[i] / sum;
      static constexpr Kind others[] = {city::town_house, city::office, city::courtyard_house};
      const Kind chosen = i == special ? kind : others[draw_.integer(0, 2)];
      const Vector3d centre(x + 0.5 * width, middle, 0.0);
      ++buildings_;
      const std::string name = "building " + std::to_string(buildings_) + " ";
      for (Part& part : chosen({width - gap, depth}, draw_, fineness_)) {
        parts_.push_back({name + part.name, moved(turned(std::move(part.mesh), azimuth), centre)});
      }
      x += width;
    }
  }

  void plant(double height, const Vector3d& at) {
    for (Part& part : tree(height, draw_, fineness_)) {
      parts_.push_back({part.name, moved(std::move(part.mesh), at)});
    }
  }

  Fineness fineness_;
  RandomNumbers draw_;
  int buildings_ = 0;
  Parts parts_;
};

}  // namespace

Parts city_block(const CityBlockOptions& options) {
  Block block(options);
  block.build_rows();
  block.pave_street();
  block.plant_trees();
  return block.result();
}

}  // namespace skycap::sim::models
