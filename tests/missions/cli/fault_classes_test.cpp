// Regression tests for faults that lost results or were not reported. docs/development/testing.md
// lists the tests by class.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <zlib.h>

#include "geometry/io/file.h"
#include "geometry/points/depth_image.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

std::string rejection(const std::vector<std::string>& arguments) {
  const tests::ProgramRun run = run_skycap(arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err << run.out;
  return run.err;
}

// Class 13: a name that is not UTF-8 is used in summary.json, the route files and the report.
TEST(FaultClasses, KeepsSurveyWithNonUtf8Name) {
  const TestFolder folder;
  const std::string mission = folder.write("\xff\xfe.yaml", tests::flight_mission());
  const auto run = run_skycap({"plan", mission, "--max-views", "2", "--out", folder / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto summary = nlohmann::json::parse(read_content(folder / "out/summary.json"));
  EXPECT_EQ(summary.at("views"), 2);
  EXPECT_TRUE(fs::exists(folder / "out/mission.plan"));
}

// Class 14: folders and link loops instead of files.
TEST(FaultClasses, ReportsFoldersAndLinkLoopsInsteadOfFiles) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", tests::quick_mission());
  for (const char* name : {"a.plan", "s.yaml", "package/summary.json"}) {
    fs::create_directories(folder / name);
  }
  fs::create_symlink(folder / "loop.plan", folder / "loop.plan");
  EXPECT_THAT(rejection({"check", mission, "--route", folder / "a.plan"}),
              HasSubstr("a.plan: is a directory"));
  EXPECT_THAT(rejection({"check", mission, "--route", folder / "loop.plan"}),
              HasSubstr("loop.plan: cannot be opened"));
  EXPECT_THAT(rejection({"scan", mission, "--sensor", folder / "s.yaml", "--out", folder / "out"}),
              HasSubstr("s.yaml: is a directory"));
  EXPECT_THAT(rejection({"export", folder / "package", "--format", "csv"}),
              HasSubstr("summary.json: is a directory"));
  const std::string loops = "loop.plan: Too many levels";
  EXPECT_THAT(
      rejection({"scan", mission, "--route", folder / "loop.plan", "--out", folder / "out"}),
      HasSubstr(loops));
  EXPECT_THAT(
      rejection({"next", mission, "--survey", folder / "live", "--dataset", folder / "loop.plan"}),
      HasSubstr(loops));
}

// Class 14: opening a pipe for reading would block forever.
TEST(FaultClasses, RejectsPipeInsteadOfFreeSpaceFile) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", tests::flight_mission());
  ASSERT_EQ(run_skycap({"plan", mission, "--max-views", "2", "--out", folder / "out"}).exit_code,
            0);
  fs::remove(folder / "out/free_space.bin");
  ASSERT_EQ(::mkfifo((folder / "out/free_space.bin").c_str(), 0600), 0);
  EXPECT_THAT(rejection({"export", folder / "out", "--format", "csv"}),
              HasSubstr("free_space.bin: is a device or a pipe"));
}

/// Redirects the user's cache during the lifetime of the object.
// NOLINTBEGIN(concurrency-mt-unsafe): no other thread asks meanwhile
class OtherCache {
 public:
  explicit OtherCache(const fs::path& folder) {
    if (const char* before = std::getenv("XDG_CACHE_HOME")) before_ = before;
    ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
  }
  OtherCache(const OtherCache&) = delete;
  OtherCache& operator=(const OtherCache&) = delete;
  ~OtherCache() {
    if (before_.empty()) {
      ::unsetenv("XDG_CACHE_HOME");
    } else {
      ::setenv("XDG_CACHE_HOME", before_.c_str(), 1);
    }
  }

 private:
  std::string before_;
};
// NOLINTEND(concurrency-mt-unsafe)

// Class 17: cached data is validated.
TEST(FaultClasses, RecomputesCorruptedCache) {
  const TestFolder folder;
  const OtherCache cache(folder.path() / "cache");
  const std::string mission = folder.write("m.yaml", tests::quick_mission());
  const auto could_be_covered = [&] {
    const auto run = run_skycap({"plan", mission, "--max-views", "2", "--set",
                                 "evaluation.attainable_views=5", "--out", folder / "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto summary = nlohmann::json::parse(read_content(folder / "out/summary.json"));
    return std::array{summary.at("attainable_coverage").get<double>(),
                      summary.at("coverage_visible").get<double>()};
  };
  const auto first = could_be_covered();
  for (const double share : first) {
    EXPECT_GT(share, 0.0);
    EXPECT_LE(share, 1.0);
  }
  std::size_t corrupted = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "cache")) {
    if (!entry.is_regular_file()) continue;
    geometry::write_file(entry.path(), std::string(read_content(entry.path()).size(), '5'));
    ++corrupted;
  }
  ASSERT_EQ(corrupted, 2U);  // visible surface and attainable coverage
  EXPECT_EQ(could_be_covered(), first);
}

// Class 20: two processes write the same file. Each writes it completely.
TEST(FaultClasses, AllowsTwoWritersOfOneFile) {
  const TestFolder folder;
  const fs::path file = folder.path() / "a.png";
  const std::string one(200'000, '1'), two(300'000, '2');
  std::atomic<int> failures = 0;
  const auto write = [&](const std::string& bytes) {
    for (int i = 0; i < 50; ++i) {
      try {
        geometry::write_file(file, bytes);
      } catch (const std::exception&) {
        ++failures;
      }
    }
  };
  std::thread other([&] { write(one); });
  write(two);
  other.join();
  EXPECT_EQ(failures, 0);
  const std::string content = read_content(file);
  EXPECT_TRUE(content == one || content == two);
}

/// Returns a compressed file of blanks with this uncompressed size.
std::string blanks(const TestFolder& folder, const std::string& name, std::size_t mebibytes) {
  const gzFile file = gzopen((folder / name).c_str(), "wb1");
  const std::string chunk(std::size_t{1} << 20, ' ');
  for (std::size_t i = 0; i < mebibytes; ++i) {
    EXPECT_EQ(gzwrite(file, chunk.data(), static_cast<unsigned>(chunk.size())),
              static_cast<int>(chunk.size()));
  }
  EXPECT_EQ(gzclose(file), Z_OK);
  return folder / name;
}

// Reading a file needs a multiple of its size: 4 GB for a cloud of 1 GiB.
TEST(FaultClasses, RejectsFilesLargerThanMemoryLimits) {
  const TestFolder folder;
  EXPECT_THAT(rejection({"model", blanks(folder, "m.obj.gz", 257)}),
              HasSubstr("larger than 256 MiB"));
  EXPECT_THAT(rejection({"evaluate", "--cloud", blanks(folder, "c.xyz.gz", 385), "--model",
                         "builtin:teapot", "--distance", "0.1"}),
              HasSubstr("larger than 384 MiB"));
  EXPECT_THAT(rejection({"report", fs::path(blanks(folder, "summary.json", 65)).parent_path()}),
              HasSubstr("larger than 64 MiB"));
  const geometry::DepthImage image{5001, 5000,
                                   std::vector<std::uint16_t>(std::size_t{5001} * 5000)};
  geometry::write_depth_png(image, folder / "d.png");
  EXPECT_THAT(rejection({"next", folder.write("m.yaml", tests::quick_mission()), "--survey",
                         folder / "live", "--scan", folder / "d.png", "--pose", "0 0 2 1 0 0 0"}),
              HasSubstr("more than 25 million pixels"));
}

}  // namespace
}  // namespace skycap::missions
