#include "geometry/io/output_folder.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
using testing_support::TemporaryFolder;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

void commit_pair(const fs::path& folder, const std::string& content) {
  OutputFolder out(folder);
  out.write("cloud", content);
  out.write("summary", content);
  out.commit();
}

// All states in which a kill can interrupt a commit: the journal exists and the first `done`
// renames have been made. The next access finds the complete new result and nothing else.
TEST(OutputFolder, CompletesCommitInterruptedAtAnyStep) {
  const std::string journal = ".part-7-cloud\0cloud\0.part-7-summary\0summary\0\0gone\0"s;
  const std::vector<std::pair<std::string, std::string>> renames = {
      {"summary", ".old-summary"}, {"cloud", ".old-cloud"},        {"gone", ".old-gone"},
      {".part-7-cloud", "cloud"},  {".part-7-summary", "summary"},
  };
  for (std::size_t done = 0; done <= renames.size(); ++done) {
    const TemporaryFolder folder;
    for (const char* name : {"cloud", "summary", "gone"}) folder.file(name, "old");
    for (const char* name : {".part-7-cloud", ".part-7-summary"}) folder.file(name, "new");
    folder.file(".commit", journal);
    for (std::size_t i = 0; i < done; ++i) {
      fs::rename(folder.path() / renames[i].first, folder.path() / renames[i].second);
    }
    finish_commit(folder.path());
    EXPECT_EQ(read_file(folder.path() / "cloud"), "new") << done;
    EXPECT_EQ(read_file(folder.path() / "summary"), "new") << done;
    { const OutputFolder next(folder.path()); }
    EXPECT_THAT(names_in(folder.path()), ElementsAre("cloud", "summary")) << done;
  }
}

TEST(OutputFolder, IgnoresJournalThatNamesFilesOutside) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "in");
  folder.file("victim", "mine");
  folder.file("in/.part-1-a", "evil");
  folder.file("in/.commit", ".part-1-a\0../victim\0\0../victim\0../victim\0a\0"s);
  finish_commit(folder.path() / "in");
  EXPECT_EQ(read_file(folder.path() / "victim"), "mine");
}

TEST(OutputFolder, KeepsEarlierResultsAfterFailedCommit) {
  const TemporaryFolder folder;
  commit_pair(folder.path(), "old");
  fs::create_directory(folder.path() / "notes");
  {
    OutputFolder out(folder.path());
    for (const char* name : {"cloud", "notes", "summary"}) out.write(name, "new");
    EXPECT_THAT([&] { out.commit(); }, ThrowsMessage<Error>(HasSubstr("notes: is a folder")));
  }
  EXPECT_EQ(read_file(folder.path() / "cloud"), "old");
  EXPECT_EQ(read_file(folder.path() / "summary"), "old");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("cloud", "notes", "summary"));
}

TEST(OutputFolder, RemovesFilesOfKilledProgram) {
  const TemporaryFolder folder;
  for (const char* name : {".part-1-cloud", ".part-0-summary", ".old-cloud", "mine"}) {
    folder.file(name, "x");
  }
  { const OutputFolder out(folder.path()); }
  EXPECT_THAT(names_in(folder.path()), ElementsAre("mine"));
}

TEST(OutputFolder, AllowsOneWriterAtATime) {
  const TemporaryFolder folder;
  const OutputFolder first(folder.path());
  EXPECT_THAT([&] { OutputFolder(folder.path()); },
              ThrowsMessage<Error>(HasSubstr("is in use by another skycap")));
}

TEST(OutputFolder, CommitsFilesStagedOnDisk) {
  const TemporaryFolder folder;
  {
    OutputFolder out(folder.path());
    write_file(out.stage_on_disk("dropped"), "1");
    write_file(out.stage_on_disk("image"), "2");
    out.drop("dropped");
    EXPECT_TRUE(out.staged("dropped").empty());
    out.commit();
  }
  EXPECT_EQ(read_file(folder.path() / "image"), "2");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("image"));
}

TEST(OutputFolder, MovesStagedFilesIntoSubfolder) {
  const TemporaryFolder folder;
  commit_pair(folder.path(), "whole");
  {
    OutputFolder out(folder.path());
    out.write("cloud", "half");
    out.move_to("interrupted");
    out.commit();
  }
  EXPECT_EQ(read_file(folder.path() / "cloud"), "whole");
  EXPECT_EQ(read_file(folder.path() / "interrupted/cloud"), "half");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("cloud", "interrupted", "summary"));
}

TEST(WriteFile, OverwritesTemporaryFileOfKilledProgram) {
  const TemporaryFolder folder;
  folder.file(".part-0-a", "a longer text than the new one");
  write_file(folder.path() / "a", "new");
  EXPECT_EQ(read_file(folder.path() / "a"), "new");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a"));
}

TEST(ReadFile, RejectsPipesDevicesAndLinkLoops) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe", zeros = folder.path() / "zeros";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", zeros);
  fs::create_symlink("loop", folder.path() / "loop");
  for (const fs::path& path : {pipe, zeros}) {
    EXPECT_THAT([&] { read_file(path); }, ThrowsMessage<Error>(HasSubstr("a regular file")));
  }
  EXPECT_THAT([&] { read_file(folder.path() / "loop"); },
              ThrowsMessage<Error>(HasSubstr("cannot be opened")));
}

TEST(ReadFile, StopsDecompressingAtLimit) {
  const TemporaryFolder folder;
  const fs::path bomb = folder.path() / "bomb.gz";
  gzFile file = gzopen(bomb.c_str(), "wb");
  const std::string zeros(std::size_t{32} << 20, '\0');
  ASSERT_EQ(gzwrite(file, zeros.data(), static_cast<unsigned>(zeros.size())),
            static_cast<int>(zeros.size()));
  gzclose(file);
  EXPECT_THAT([&] { read_file(bomb, std::size_t{1} << 20); },
              ThrowsMessage<Error>(HasSubstr("larger than 1 MiB when decompressed")));
}

}  // namespace
}  // namespace skycap::geometry
