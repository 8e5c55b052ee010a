// Each file in tests/fuzz/corpus is read by its reader: complete, truncated and with changed bytes.
// This repeats in seconds what libFuzzer does for hours. CORPUS_SEED and CORPUS_CHANGES in the
// environment set the random seed and the number of changes for each file.
#include <algorithm>
#include <cstdlib>
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

std::vector<fs::path> find_corpus_files(const Reader& reader) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(FUZZ_CORPUS) / reader.name)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// Returns the raw bytes. read_file() would decompress gzip files.
std::string read_bytes(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint32_t number_in_environment(const char* name, std::uint32_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<std::uint32_t>(std::stoul(text));
}

void change_bytes(std::string& bytes, std::mt19937& random) {
  constexpr std::string_view structural_bytes = "\xff\x7f\x80 -9e[{<:,.0\n";
  for (int i = 0; i < 3; ++i) {
    bytes[random() % bytes.size()] =
        i == 0 ? static_cast<char>(random()) : structural_bytes[random() % structural_bytes.size()];
  }
}

/// Cuts out a chunk, or inserts a copy of it at another position.
void move_chunk(std::string& bytes, std::mt19937& random) {
  const std::size_t begin = random() % bytes.size();
  const std::string chunk = bytes.substr(begin, 1 + random() % 64);
  if (random() % 2 == 0) {
    bytes.erase(begin, chunk.size());
  } else {
    bytes.insert(random() % bytes.size(), chunk);
  }
}

/// Replaces a number in text, or four or eight bytes, by an extreme value.
void make_extreme(std::string& bytes, std::mt19937& random) {
  static const std::vector<std::string> texts = {"0",    "-1",  "1e308",      "-1e-320",
                                                 "nan",  "inf", "4294967296", "9223372036854775808",
                                                 "1e39", "00"};
  static const std::vector<std::string> binaries = {std::string(4, '\xff'),
                                                    std::string(8, '\xff'),
                                                    std::string("\xff\xff\xff\x7f"),
                                                    std::string("\0\0\x80\x7f", 4),
                                                    std::string(8, '\0'),
                                                    std::string("\0\0\0\0\0\0\xf0\x7f", 8)};
  const std::size_t digit = bytes.find_first_of("0123456789", random() % bytes.size());
  if (digit != std::string::npos && random() % 2 == 0) {
    const std::size_t end = std::min(bytes.find_first_not_of("0123456789.e-", digit), bytes.size());
    bytes.replace(digit, end - digit, texts[random() % texts.size()]);
  } else {
    const std::string& binary = binaries[random() % binaries.size()];
    bytes.replace(random() % bytes.size(), binary.size(), binary);
  }
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

TEST_P(Corpus, ReadsOrRejectsFiles) {
  const std::vector<fs::path> files = find_corpus_files(GetParam());
  ASSERT_FALSE(files.empty());
  for (const fs::path& path : files) expect_held(read_bytes(path), path.filename());
}

TEST_P(Corpus, ReadsOrRejectsTruncatedFiles) {
  for (const fs::path& path : find_corpus_files(GetParam())) {
    const std::string bytes = read_bytes(path);
    for (std::size_t part = 0; part < 12; ++part) {
      expect_held(bytes.substr(0, bytes.size() * part / 12), path.filename());
    }
  }
}

TEST_P(Corpus, ReadsOrRejectsFilesWithChangedBytes) {
  std::mt19937 random(number_in_environment("CORPUS_SEED", 1));
  const std::uint32_t changes = number_in_environment("CORPUS_CHANGES", 200);
  for (const fs::path& path : find_corpus_files(GetParam())) {
    for (std::uint32_t change = 0; change < changes; ++change) {
      std::string bytes = read_bytes(path);
      if (bytes.empty()) continue;
      for (const auto& make : {change_bytes, move_chunk, make_extreme}) {
        if (random() % 2 == 0 && !bytes.empty()) make(bytes, random);
      }
      expect_held(bytes, path.filename().string() + ", change " + std::to_string(change));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(all_readers()),
                         [](const auto& reader) { return std::string(reader.param.name); });

}  // namespace
}  // namespace skycap::fuzz
