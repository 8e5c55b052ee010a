#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "geometry/io/record_log.h"
#include "missions/evaluation/reachable_space.h"

namespace skycap::missions::evaluation {
namespace {

constexpr char file_mark[16] = "skycap reach v1";
constexpr std::uint64_t max_nodes = 1U << 28;

/// File header, followed by the 4-byte states of the cells.
struct Head {
  char mark[16];
  double cell;
  double origin[3];
  std::int32_t width;
  std::uint8_t is_floored, is_outside_reached, is_empty, unused;
  std::uint64_t nodes;
  std::uint32_t checksum;
  std::uint32_t unused_too;
};

/// Returns the checksum of the cells and the other header fields.
std::uint32_t compute_checksum(Head head, const std::vector<std::uint32_t>& nodes) {
  head.checksum = geometry::compute_crc32(
      {reinterpret_cast<const char*>(nodes.data()), nodes.size() * sizeof(std::uint32_t)});
  return geometry::compute_crc32({reinterpret_cast<const char*>(&head), sizeof head});
}

}  // namespace

std::string ReachableSpace::bytes() const {
  Head head{};
  std::memcpy(head.mark, file_mark, sizeof head.mark);
  head.cell = cell_;
  for (int axis = 0; axis < 3; ++axis) head.origin[axis] = origin_[axis];
  head.width = width_;
  head.is_floored = is_floored_, head.is_outside_reached = is_outside_reached_;
  head.is_empty = is_empty_;
  head.nodes = nodes_.size();
  head.checksum = compute_checksum(head, nodes_);
  std::string text(sizeof head + nodes_.size() * sizeof(std::uint32_t), '\0');
  std::memcpy(text.data(), &head, sizeof head);
  std::memcpy(text.data() + sizeof head, nodes_.data(), nodes_.size() * sizeof(std::uint32_t));
  return text;
}

std::optional<ReachableSpace> ReachableSpace::read(std::string_view bytes) {
  Head head{};
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (std::memcmp(head.mark, file_mark, sizeof head.mark) != 0 || head.nodes == 0 ||
      head.nodes > max_nodes || bytes.size() != sizeof head + head.nodes * sizeof(std::uint32_t)) {
    return std::nullopt;
  }
  ReachableSpace space;
  space.cell_ = head.cell;
  space.origin_ = {head.origin[0], head.origin[1], head.origin[2]};
  space.width_ = head.width;
  space.is_floored_ = head.is_floored != 0;
  space.is_outside_reached_ = head.is_outside_reached != 0;
  space.is_empty_ = head.is_empty != 0;
  space.nodes_.resize(head.nodes);
  std::memcpy(space.nodes_.data(), bytes.data() + sizeof head, head.nodes * sizeof(std::uint32_t));
  if (compute_checksum(head, space.nodes_) != head.checksum || !space.is_whole())
    return std::nullopt;
  return space;
}

/// Returns whether the octree is valid, so that every query terminates. Sizes are powers of two,
/// children follow their parents, and the depth does not exceed the number of sizes.
bool ReachableSpace::is_whole() const {
  const bool is_power = width_ > 0 && (width_ & (width_ - 1)) == 0;
  if (!is_power || !(cell_ > 0.0) || !std::isfinite(cell_) || !origin_.allFinite()) return false;
  struct Part {
    std::size_t node;
    std::int32_t size;
  };
  std::vector<Part> pending{{0, width_}};
  std::size_t seen = 0;
  while (!pending.empty()) {
    const Part part = pending.back();
    pending.pop_back();
    if (++seen > nodes_.size()) return false;
    const std::uint32_t first = nodes_[part.node];
    if (is_leaf(first)) continue;
    if (part.size == 1 || first <= part.node || first + 8ULL > nodes_.size()) return false;
    for (std::size_t child = 0; child < 8; ++child) {
      pending.push_back({first + child, part.size / 2});
    }
  }
  return true;
}

}  // namespace skycap::missions::evaluation
