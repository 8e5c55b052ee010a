#include "missions/batch/campaign/key_changes.h"

#include <algorithm>
#include <utility>

#include "geometry/error.h"
#include "missions/config/mission_keys.h"
#include "missions/config/unknown_key.h"
#include "missions/support/flow_text.h"
#include "missions/support/key_text.h"

namespace skycap::missions::batch {
namespace {

class ChangeReader {
 public:
  ChangeReader(const std::string& path, const std::string& file, const FollowingKeys& following)
      : path_(path), file_(file), following_(following) {}

  /// `section` goes before the names of the entries' keys.
  void read(const std::vector<support::YamlEntry>& entries, const std::string& section) {
    for (const support::YamlEntry& entry : entries) {
      const std::string key = section + entry.key;
      if (following_.holds(key)) fail(entry.line, key, "follows from " + following_.instead);
      if (config::find_key(key) != nullptr) {
        changes_.push_back({place(entry.line), key, support::flow_text(entry.value)});
      } else if (entry.value.kind == support::YamlNode::Kind::map) {
        read(entry.value.entries, key + ".");
      } else {
        fail(entry.line, key, config::unknown_key_message(key, config::mission_keys()));
      }
    }
  }

  std::vector<config::KeyOverride> changes() { return std::move(changes_); }

 private:
  std::string place(int line) const { return file_ + ":" + std::to_string(line); }

  [[noreturn]] void fail(int line, const std::string& key, const std::string& what) const {
    throw Error(ErrorKind::bad_config,
                place(line) + ": key " + support::about_key(path_ + key, what));
  }

  const std::string& path_;
  const std::string& file_;
  const FollowingKeys& following_;
  std::vector<config::KeyOverride> changes_;
};

}  // namespace

bool FollowingKeys::holds(const std::string& key) const {
  return std::ranges::any_of(keys, [&](const std::string& own) {
    return own == key || (own.ends_with('.') && key.starts_with(own));
  });
}

std::vector<config::KeyOverride> key_changes(const std::vector<support::YamlEntry>& entries,
                                             const std::string& path, const std::string& file,
                                             const FollowingKeys& following) {
  ChangeReader reader(path, file, following);
  reader.read(entries, "");
  return reader.changes();
}

}  // namespace skycap::missions::batch
