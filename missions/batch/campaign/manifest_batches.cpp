#include "missions/batch/campaign/manifest_batches.h"

#include <string>
#include <utility>

#include "geometry/io/file.h"
#include "missions/batch/benchmark/contestants.h"

namespace skycap::missions::batch {
namespace {

constexpr std::size_t most_setups = 64;
constexpr const char* record_name = "item.json";

std::shared_ptr<const Setup> setup_of(const Manifest& manifest, const ManifestEntry& entry,
                                      const std::filesystem::path& out,
                                      const config::Report& report) {
  const batch::Contestant* contestant =
      entry.planner.empty() ? nullptr : batch::find_contestant(entry.planner);
  const std::filesystem::path file = manifest.file().folder / entry.mission;
  geometry::require_regular_file(file);  // a pipe would keep all others waiting
  Setup setup = read_setup(file, contestant, "planners", entry.variant->changes, report);
  setup.title = entry.title;
  setup.truth_file = out / "scenes" / setup.fingerprint;
  if (manifest.file().results == ItemResults::package) setup.fingerprint += " package";
  return std::make_shared<const Setup>(std::move(setup));
}

}  // namespace

std::vector<std::size_t> numbers_of_entry(const Manifest& manifest, std::size_t entry,
                                          const ItemRange& range) {
  std::vector<std::size_t> numbers;
  const std::size_t entries = manifest.entries();
  for (std::size_t round = range.first / entries; round * entries < range.end; ++round) {
    const std::size_t number = round * entries + entry;
    if (number >= range.first && number < range.end) numbers.push_back(number);
  }
  return numbers;
}

void for_each_batch(const Manifest& manifest, const std::filesystem::path& out,
                    const ItemRange& range, const BatchEvents& events) {
  const ItemForm form =
      manifest.file().results == ItemResults::package ? ItemForm::package : ItemForm::folder;
  Batch batch;
  std::size_t setups = 0;
  std::string title;
  for (std::size_t index = 0; index < manifest.entries(); ++index) {
    const std::vector<std::size_t> numbers = numbers_of_entry(manifest, index, range);
    if (numbers.empty()) continue;
    const ManifestEntry entry = manifest.entry(index);
    // Planners of one scene stay together.
    if (setups >= most_setups && entry.title != title) {
      events.work(std::exchange(batch, {}));
      setups = 0;
    }
    title = entry.title;
    try {
      const auto setup = setup_of(manifest, entry, out, events.reading);
      ++setups;
      for (const std::size_t number : numbers) {
        const ManifestLine line = manifest.line(number);
        batch.items.push_back({setup, line.seed, out / line.folder() / record_name, form});
        batch.numbers.push_back(number);
      }
    } catch (const Error& error) {
      events.failed(error, numbers.size());
    }
  }
  if (!batch.items.empty()) events.work(batch);
}

}  // namespace skycap::missions::batch
