/// The items of a manifest as surveys, some at a time: missions may hold prior data of a whole town
/// each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "geometry/error.h"
#include "missions/batch/campaign/manifest.h"
#include "missions/batch/campaign/survey_item.h"
#include "missions/batch/campaign/task_index.h"

namespace skycap::missions::batch {

/// Items that are next to each other by mission, variant, planner and seed, in this order.
struct Batch {
  std::vector<Item> items;
  std::vector<std::size_t> numbers;  ///< in the manifest
};

struct BatchEvents {
  std::function<void(const Batch&)> work;
  /// A mission cannot be read, and so many of the range's items not be run.
  std::function<void(const Error&, std::size_t items)> failed;
  config::Report reading{};  ///< what of a mission is read
};

/// Hands on all items of the range; results are in `out`.
void for_each_batch(const Manifest& manifest, const std::filesystem::path& out,
                    const ItemRange& range, const BatchEvents& events);

/// The numbers of the range that belong to an entry, ascending.
std::vector<std::size_t> numbers_of_entry(const Manifest& manifest, std::size_t entry,
                                          const ItemRange& range);

}  // namespace skycap::missions::batch
