#include "survey/pb_nbv/candidate_views.h"

#include <cmath>
#include <numbers>

namespace skycap::survey::pb_nbv {

constexpr double pi = std::numbers::pi;

std::vector<Eigen::Vector3d> make_candidate_directions(const PbNbvSettings& settings) {
  const double max_angle = settings.region == Region::sphere ? pi : 0.5 * pi;
  const auto angle = [&](std::size_t i) {
    return max_angle * static_cast<double>(i) / static_cast<double>(settings.parallels);
  };
  double sines = 0.0;
  for (std::size_t i = 0; i < settings.parallels; ++i) sines += std::sin(angle(i));
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t i = 0; i < settings.parallels; ++i) {
    const double polar = angle(i);
    const double share = static_cast<double>(settings.candidates) * std::sin(polar) / sines;
    const auto count = static_cast<std::size_t>(std::lround(share));
    for (std::size_t j = 0; j < count; ++j) {
      const double azimuth = 2.0 * pi * static_cast<double>(j) / static_cast<double>(count);
      directions.emplace_back(std::sin(polar) * std::cos(azimuth),
                              std::sin(polar) * std::sin(azimuth), std::cos(polar));
    }
  }
  return directions;
}

std::size_t SectorRule::sector(double azimuth) const {
  const double width = 2.0 * pi / static_cast<double>(sectors_);
  const double turns = (azimuth - first_azimuth_ + 0.5 * width) / (2.0 * pi);
  const double within = turns - std::floor(turns);
  const auto number = static_cast<std::size_t>(within * static_cast<double>(sectors_));
  return number < sectors_ ? number : sectors_ - 1;
}

void SectorRule::visit(std::size_t sector) {
  if (is_complete()) return;
  if (sector == left_) {
    ++left_;
  } else if (sector == right_) {
    --right_;
  }
}

void SectorRule::skip() {
  if (is_complete()) return;
  ++left_;
  --right_;
}

}  // namespace skycap::survey::pb_nbv
