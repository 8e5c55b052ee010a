#include "survey/skycap/clearness.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace skycap::survey::skycap {
namespace {

using Eigen::Vector3f;

constexpr float stretch = 3.0F;  // of the way before a place that is asked about, in scales

}  // namespace

Clearness::Clearness(float scale) {
  std::array<float, pieces> lengths{};
  float from = 0.0F;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    lengths[piece] =
        stretch * scale * static_cast<float>(1U << piece) / static_cast<float>(all_unknown);
    middles_[piece] = from + 0.5F * lengths[piece];
    from += lengths[piece];
  }
  for (std::uint32_t unknown = 0; unknown <= all_unknown; ++unknown) {
    float length = 0.0F;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      if ((unknown >> piece & 1U) != 0) length += lengths[piece];
    }
    probabilities_[unknown] = std::exp(-length / scale);
  }
  const auto middle = [](std::size_t cell) {
    return (2.0F * static_cast<float>(cell) + 1.0F) / ways_to_a_face - 1.0F;
  };
  std::size_t way = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      for (std::size_t i = 0; i < ways_to_a_face; ++i) {
        for (std::size_t j = 0; j < ways_to_a_face; ++j) {
          Vector3f& direction = directions_[way++];
          direction[axis] = side;
          direction[(axis + 1) % 3] = middle(i);
          direction[(axis + 2) % 3] = middle(j);
          direction.normalize();
        }
      }
    }
  }
}

std::size_t Clearness::way_towards(const Vector3f& offset) {
  Eigen::Index axis = 0;
  const float longest = offset.cwiseAbs().maxCoeff(&axis);
  const auto cell = [&](Eigen::Index other) {
    const float share = 0.5F * (offset[other % 3] / longest + 1.0F);
    return std::min(static_cast<std::size_t>(ways_to_a_face * share),
                    std::size_t{ways_to_a_face - 1});
  };
  const std::size_t face = 2 * static_cast<std::size_t>(axis) + (offset[axis] > 0.0F ? 1 : 0);
  return (face * ways_to_a_face + cell(axis + 1)) * ways_to_a_face + cell(axis + 2);
}

void Clearness::update(std::span<const UnseenPatch> patches, const SpaceMemory& space) {
  std::vector<std::uint32_t> asked(patches.size() * ways, all_unknown);
  std::unordered_map<std::uint64_t, Row> rows;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const UnseenPatch& patch = patches[i];
    const auto old = rows_.find(patch.place);
    // Another surfel's guess may go by the same name, a little beside.
    if (old != rows_.end() && old->second.position == patch.position) {
      std::copy_n(asked_.begin() + static_cast<std::ptrdiff_t>(old->second.number * ways), ways,
                  asked.begin() + static_cast<std::ptrdiff_t>(i * ways));
    }
    rows.emplace(patch.place, Row{i, patch.position});
  }
  asked_ = std::move(asked);
  rows_ = std::move(rows);
  patches_ = patches;
  space_ = &space;
}

float Clearness::of(std::size_t i, const Vector3f& sensor) const {
  const UnseenPatch& patch = patches_[i];
  const auto images = static_cast<std::uint32_t>(space_->image_count());
  if (images == 0 || patch.kind == prior_kind) return 1.0F;
  const Vector3f offset = sensor - patch.position;
  const std::size_t way = offset.isZero() ? 0 : way_towards(offset);
  // Threads that ask the same at once find the same.
  std::atomic_ref<std::uint32_t> asked(asked_[i * ways + way]);
  const std::uint32_t before = asked.load(std::memory_order_relaxed);
  std::uint32_t unknown = before & all_unknown;
  const std::uint32_t first = before >> pieces;
  if (first == images) return probabilities_[unknown];
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    if ((unknown >> piece & 1U) == 0) continue;
    const Vector3f at = patch.position + middles_[piece] * directions_[way];
    if (space_->query(at, first) != SpaceState::unknown) unknown &= ~(1U << piece);
  }
  asked.store(images << pieces | unknown, std::memory_order_relaxed);
  return probabilities_[unknown];
}

}  // namespace skycap::survey::skycap
