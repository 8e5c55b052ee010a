/// Scenes of missions, each made ready when it is first asked for and dropped after its last use.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "geometry/error.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/batch/campaign/survey_item.h"
#include "missions/evaluation/survey_scene.h"

namespace skycap::missions::batch {

struct PreparedScene {
  evaluation::SurveyScene scene;
  batch::SceneTruth truth;
};

/// Safe to use from several threads.
class PreparedScenes {
 public:
  /// `uses` are how often each title's scene will be taken. All scenes together are made ready with
  /// `threads` threads.
  PreparedScenes(const std::map<std::string, std::size_t>& uses, unsigned threads);

  /// The scene of the setup's mission, for one use; null if `stop` came first. `preparing` is
  /// called before it is made ready. Throws what that throws, each time, and Error{bad_config} if
  /// the mission cannot be surveyed in it.
  std::shared_ptr<const PreparedScene> take(const Setup& setup, const std::stop_token& stop,
                                            const std::function<void()>& preparing);

 private:
  struct Slot {
    std::mutex mutex;
    std::size_t uses = 0;
    std::shared_ptr<const PreparedScene> scene;
    std::optional<Error> failure;
  };

  std::map<std::string, Slot> slots_;
  unsigned threads_;  ///< for each scene
};

}  // namespace skycap::missions::batch
