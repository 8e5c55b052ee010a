// Each file of tests/fuzz/corpus is read by its reader, whole, cut short, and with bytes changed:
// what libFuzzer does for hours, for seconds.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/io/file.h"
#include "tests/fuzz/readers.h"

namespace skycap::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> corpus_of(const Reader& reader) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(FUZZ_CORPUS) / reader.name)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// The bytes as they are, but those of gzip, which read_file() would decompress.
std::string bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Corpus : public testing::TestWithParam<Reader> {
 protected:
  static void expect_held(const std::string& bytes, const std::string& what) {
    try {
      GetParam().run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    } catch (const std::exception& finding) {
      ADD_FAILURE() << what << ": " << finding.what();
    }
  }
};

TEST_P(Corpus, FilesAreReadOrRefused) {
  const std::vector<fs::path> files = corpus_of(GetParam());
  ASSERT_FALSE(files.empty());
  for (const fs::path& path : files) expect_held(bytes_of(path), path.filename());
}

TEST_P(Corpus, FilesThatAreCutShortAreReadOrRefused) {
  for (const fs::path& path : corpus_of(GetParam())) {
    const std::string bytes = bytes_of(path);
    for (std::size_t part = 0; part < 12; ++part) {
      expect_held(bytes.substr(0, bytes.size() * part / 12), path.filename());
    }
  }
}

TEST_P(Corpus, FilesWithChangedBytesAreReadOrRefused) {
  std::mt19937 random(1);
  for (const fs::path& path : corpus_of(GetParam())) {
    for (int change = 0; change < 200; ++change) {
      std::string bytes = bytes_of(path);
      for (int i = 0; i < 3 && !bytes.empty(); ++i) {
        constexpr std::string_view telling = "\xff\x7f\x80 -9e[{<:,.0\n";
        bytes[random() % bytes.size()] =
            i == 0 ? static_cast<char>(random()) : telling[random() % telling.size()];
      }
      expect_held(bytes, path.filename().string() + ", change " + std::to_string(change));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(all_readers()),
                         [](const auto& reader) { return std::string(reader.param.name); });

}  // namespace
}  // namespace skycap::fuzz
