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
#include "tests/fuzz/structure.h"

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

/// Number of changes of each file: all files of a reader together are changed as often as one to
/// four files.
std::uint32_t changes_per_file(std::size_t files) {
  const std::uint32_t changes = number_in_environment("CORPUS_CHANGES", 200);
  return std::max<std::uint32_t>(
      1, changes * 4 / static_cast<std::uint32_t>(std::max<std::size_t>(files, 4)));
}

TEST_P(Corpus, ReadsOrRejectsFilesWithChangedBytes) {
  std::mt19937 random(number_in_environment("CORPUS_SEED", 1));
  const auto files = find_corpus_files(GetParam());
  for (const fs::path& path : files) {
    for (std::uint32_t change = 0; change < changes_per_file(files.size()); ++change) {
      std::string bytes = read_bytes(path);
      if (bytes.empty()) continue;
      for (const auto& make : {change_bytes, move_chunk, make_extreme}) {
        if (random() % 2 == 0 && !bytes.empty()) make(bytes, random);
      }
      expect_held(bytes, path.filename().string() + ", change " + std::to_string(change));
    }
  }
}

std::mt19937 bytes_random;

std::string change_any_bytes(std::string bytes, std::size_t max) {
  if (bytes.empty()) return std::string(std::min<std::size_t>(max, 1), '0');
  change_bytes(bytes, bytes_random);
  return bytes;
}

TEST_P(Corpus, ReadsOrRejectsFilesWithChangedStructure) {
  const Structure* const structure = find_structure(GetParam().name);
  if (structure == nullptr) return;
  std::mt19937 random(number_in_environment("CORPUS_SEED", 1));
  bytes_random.seed(random());
  const auto files = find_corpus_files(GetParam());
  for (const fs::path& path : files) {
    for (std::uint32_t change = 0; change < changes_per_file(files.size()) / 2 + 1; ++change) {
      const std::string bytes =
          mutated(*structure, read_bytes(path), random, 1 << 16, change_any_bytes);
      expect_held(bytes,
                  path.filename().string() + ", structural change " + std::to_string(change));
    }
  }
}

/// A structure that lost parts or their lengths would hide them from the fuzzer.
TEST(Structures, JoinTheirPartsToTheSameParts) {
  for (const Structure& structure : all_structures()) {
    for (const std::string_view reader : structure.readers) {
      if (find_reader(reader).run == nullptr) continue;  // requires ROS 2
      for (const fs::path& path : find_corpus_files(find_reader(reader))) {
        const auto raw_parts = structure.split(read_bytes(path));
        if (raw_parts.empty()) continue;
        const auto parts = structure.split(structure.join(raw_parts));  // without damaged bytes
        EXPECT_EQ(parts.size(), raw_parts.size()) << path;
        EXPECT_EQ(structure.split(structure.join(parts)), parts) << path;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(all_readers()),
                         [](const auto& reader) { return std::string(reader.param.name); });

}  // namespace
}  // namespace skycap::fuzz
