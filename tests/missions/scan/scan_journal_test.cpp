#include "missions/scan/scan_journal.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"

namespace skycap::missions::scan {
namespace {

TEST(ScanJournal, MatchesTheInterruptedScanWithTheSameInputsOnly) {
  const testing_support::TemporaryFolder folder;
  const support::Identity run{7, {{"scene.model", "builtin:teapot"}}};
  const support::Identity other_seed{8, run.settings};
  const support::Identity other_scene{7, {{"scene.model", "builtin:city-block"}}};
  const nlohmann::ordered_json more{{"shard", "1/2"}};
  EXPECT_FALSE(ScanJournal(folder.path()).matches_run(run, more));
  {
    ScanJournal journal(folder.path());
    journal.open(run, more, false);
    journal.checkpoint({{"points", 12}});
  }
  const ScanJournal journal(folder.path());
  EXPECT_TRUE(journal.matches_run(run, more));
  EXPECT_FALSE(journal.matches_run(other_seed, more));
  EXPECT_FALSE(journal.matches_run(other_scene, more));
  EXPECT_FALSE(journal.matches_run(run, {{"shard", "2/2"}}));
}

}  // namespace
}  // namespace skycap::missions::scan
