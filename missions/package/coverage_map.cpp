#include "missions/package/coverage_map.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace skycap::missions::package {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour covered_surely{0, 110, 60}, covered_hardly{170, 220, 120};
constexpr Colour amber{255, 170, 0}, red{215, 30, 40}, violet{120, 60, 200};

/// Interpolates between the colours for coverage probabilities of 0.5 and 1.
Colour covered_colour(float covered_share) {
  const float sure = std::clamp(2.0F * covered_share - 1.0F, 0.0F, 1.0F);
  Colour colour{};
  for (std::size_t i = 0; i < colour.size(); ++i) {
    colour[i] =
        static_cast<std::uint8_t>((1.0F - sure) * covered_hardly[i] + sure * covered_surely[i]);
  }
  return colour;
}

Colour make_colour(const survey::surfel::EstimatedPatch& patch) {
  switch (patch.reason) {
    case survey::surfel::MissingReason::seen_too_thinly:
      return amber;
    case survey::surfel::MissingReason::never_seen:
      return red;
    case survey::surfel::MissingReason::unreachable:
      return violet;
    case survey::surfel::MissingReason::none:
      break;
  }
  return covered_colour(patch.covered_share);
}

}  // namespace

geometry::AttributedCloud coverage_map(std::span<const survey::surfel::EstimatedPatch> patches) {
  geometry::AttributedCloud map;
  for (const survey::surfel::EstimatedPatch& patch : patches) {
    map.positions.push_back(patch.position);
    map.normals.push_back(patch.normal);
    map.colours.push_back(make_colour(patch));
  }
  return map;
}

void write_true_coverage(const std::filesystem::path& path, const TrueCoverage& truth) {
  const auto is_marked = [](const std::vector<std::uint8_t>& marks, std::size_t i) {
    return marks.empty() || marks[i] != 0;
  };
  std::vector<Colour> colours;
  for (std::size_t i = 0; i < truth.is_covered.size(); ++i) {
    colours.push_back(truth.is_covered[i] != 0             ? covered_surely
                      : !is_marked(truth.is_visible, i)    ? violet
                      : !is_marked(truth.is_attainable, i) ? amber
                                                           : red);
  }
  geometry::write_cloud(path, {.positions = truth.samples.points,
                               .normals = truth.samples.normals,
                               .views = {},
                               .colours = colours,
                               .marks = {{"covered", truth.is_covered},
                                         {"visible", truth.is_visible},
                                         {"attainable", truth.is_attainable}}});
}

std::optional<survey::surfel::MissingReason> find_reason(const Colour& colour) {
  using enum survey::surfel::MissingReason;
  if (colour == amber) return seen_too_thinly;
  if (colour == red) return never_seen;
  if (colour == violet) return unreachable;
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const auto [min, max] = std::minmax(covered_hardly[i], covered_surely[i]);
    if (colour[i] < min || colour[i] > max) return std::nullopt;
  }
  return none;
}

}  // namespace skycap::missions::package
