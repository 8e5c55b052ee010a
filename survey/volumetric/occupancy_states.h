/// Table of the occupancy values of voxels, with precomputed quantities for the information gains.
/// A voxel of the map thus needs only two bytes, and rays compute no logarithms.
///
/// Occupancy is stored as log-odds L(p) = ln(p / (1 - p)) in single precision. Each measurement
/// adds L(hit) or L(miss), clamped to two limits (Hornung et al., OctoMap, Autonomous Robots 34
/// (2013), Eqs. 2 to 4). Clamping and rounding leave about ten thousand values in a survey. Each
/// value gets a code when it first occurs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace skycap::survey::volumetric {

/// Sensor model, as probabilities in (0, 1). Defaults: those of Delmerico et al. (2017).
struct OccupancyModel {
  double hit = 0.7;            ///< occupancy after one hit in an untouched voxel
  double miss = 0.4;           ///< occupancy after one ray through an untouched voxel
  double clamping_min = 0.12;  ///< minimum occupancy
  double clamping_max = 0.97;  ///< maximum occupancy
};

/// State of a voxel by the thresholds of the information gains.
enum class VoxelKind : std::uint8_t {
  untouched,  ///< not affected by any measurement
  shadowed,   ///< unmeasured, behind a measured surface
  free,       ///< measured, occupancy below 0.2
  uncertain,  ///< measured, occupancy from 0.2 to 0.8
  occupied,   ///< measured, occupancy above 0.8
};

/// Value of voxels. Unmeasured voxels have the prior occupancy 0.5.
struct VoxelState {
  double occupancy = 0.5;
  double entropy = 0.6931471805599453;  ///< -p ln p - (1 - p) ln(1 - p) [nat]
  std::uint16_t shadow_depth = 0;       ///< voxels behind the surface, if shadowed
  VoxelKind kind = VoxelKind::untouched;
  bool stops_rays = false;  ///< measured, with an occupancy of at least 0.5
};

/// Assigns codes to voxel states. Code 0 is untouched. Codes from 1 to deepest_shadow are shadowed,
/// with the depth as code. Higher codes are measured.
class OccupancyStates {
 public:
  using Code = std::uint16_t;
  static constexpr Code untouched = 0;
  static constexpr Code deepest_shadow = 4095;
  static constexpr std::size_t max_states = std::size_t{1} << 16;

  /// Assigns codes to up to `capacity` states. Beyond that, a new value is replaced by the nearest
  /// existing one.
  explicit OccupancyStates(const OccupancyModel& model, std::size_t capacity = max_states);

  /// Returns the code of a voxel after one more hit, or after one more ray through it. An
  /// unmeasured voxel starts with log-odds of zero.
  Code after_hit(Code code) { return successor(code, hit_, &Value::after_hit); }
  Code after_miss(Code code) { return successor(code, miss_, &Value::after_miss); }

  static bool is_measured(Code code) { return code > deepest_shadow; }
  const VoxelState& state(Code code) const { return states_[code]; }
  /// Returns the log-odds of a measured voxel.
  float log_odds(Code code) const { return values_[code - first_measured].log_odds; }
  /// Returns all states by code, for inner loops. Valid until the next after_hit() or after_miss().
  const VoxelState* table() const { return states_.data(); }
  std::size_t size() const { return states_.size(); }

 private:
  static constexpr Code first_measured = deepest_shadow + 1;

  struct Value {
    float log_odds;
    Code after_hit = untouched;  // untouched: not computed yet
    Code after_miss = untouched;
  };
  Code successor(Code code, float change, Code Value::*known);
  Code find_code(float log_odds);

  float hit_, miss_, clamping_min_, clamping_max_;
  std::size_t capacity_;
  std::vector<VoxelState> states_;  // by code
  std::vector<Value> values_;       // values of the measured states
  std::unordered_map<float, Code> codes_;
};

}  // namespace skycap::survey::volumetric
