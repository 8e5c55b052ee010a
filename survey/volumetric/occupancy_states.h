/// The values that a voxel's occupancy can take, each with what the information gains want to know
/// of it, so that a voxel of the map is two bytes and a ray does no logarithms.
///
/// Occupancy is kept as log-odds L(p) = ln(p / (1 - p)), in single precision, to which every
/// measurement adds L(hit) or L(miss) between two clamps: Hornung et al., OctoMap, Autonomous
/// Robots 34 (2013), Eqs. 2 to 4. The clamps and the rounding leave some ten thousand values that
/// voxels of a survey ever have; each is numbered when it first occurs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace skycap::survey::volumetric {

/// The sensor model, as probabilities in (0, 1). Defaults: those of Delmerico et al. (2017).
struct OccupancyModel {
  double hit = 0.7;       ///< occupancy after one measurement in an untouched voxel
  double miss = 0.4;      ///< occupancy after one ray through an untouched voxel
  double lowest = 0.12;   ///< no voxel is freer
  double highest = 0.97;  ///< nor more occupied
};

/// What is known of a voxel, by the thresholds that the information gains use.
enum class VoxelKind : std::uint8_t {
  untouched,  ///< no measurement has to do with it
  shadowed,   ///< not measured, but behind a measured surface
  free,       ///< measured, occupancy below 0.2
  uncertain,  ///< measured, occupancy in between
  occupied,   ///< measured, occupancy above 0.8
};

/// A value that voxels have. Unmeasured ones have the prior occupancy 0.5.
struct VoxelState {
  double occupancy = 0.5;
  double entropy = 0.6931471805599453;  ///< -p ln p - (1 - p) ln(1 - p), in nats
  std::uint16_t shadow_depth = 0;       ///< cells behind the surface, if shadowed
  VoxelKind kind = VoxelKind::untouched;
  bool stops_rays = false;  ///< measured, and occupancy is 0.5 or more
};

/// Numbers voxel states. Code 0 is untouched; 1 to deepest_shadow are shadowed, the code being
/// the depth; higher codes are measured.
class OccupancyStates {
 public:
  using Code = std::uint16_t;
  static constexpr Code untouched = 0;
  static constexpr Code deepest_shadow = 4095;
  static constexpr std::size_t most_states = std::size_t{1} << 16;

  /// Numbers up to `capacity` states; beyond, a new value is replaced by the nearest numbered one.
  explicit OccupancyStates(const OccupancyModel& model, std::size_t capacity = most_states);

  /// The code after one more measurement in the voxel, or one more ray through it. An unmeasured
  /// voxel starts from log-odds zero.
  Code after_hit(Code code) { return successor(code, hit_, &Value::after_hit); }
  Code after_miss(Code code) { return successor(code, miss_, &Value::after_miss); }

  static bool is_measured(Code code) { return code > deepest_shadow; }
  const VoxelState& state(Code code) const { return states_[code]; }
  /// Log-odds of a measured voxel's code.
  float log_odds(Code code) const { return values_[code - first_measured].log_odds; }
  /// All states by code, for inner loops. Valid until the next after_hit() or after_miss().
  const VoxelState* table() const { return states_.data(); }
  std::size_t size() const { return states_.size(); }

 private:
  static constexpr Code first_measured = deepest_shadow + 1;

  struct Value {
    float log_odds;
    Code after_hit = untouched;  // untouched: not known yet
    Code after_miss = untouched;
  };
  Code successor(Code code, float change, Code Value::*known);
  Code code_of(float log_odds);

  float hit_, miss_, lowest_, highest_;
  std::size_t capacity_;
  std::vector<VoxelState> states_;  // by code
  std::vector<Value> values_;       // of the measured states
  std::unordered_map<float, Code> codes_;
};

}  // namespace skycap::survey::volumetric
