/// Mutations that keep a format's structure: an input is split into the parts that may change
/// separately, such as the files of an archive or the messages of a log. The changed parts are
/// joined with valid lengths, checksums and compression. Otherwise, most mutations would end at the
/// first of these checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::fuzz {

/// Format of the inputs of some readers.
struct Structure {
  enum class Content { text, binary, mixed };  ///< mixed: depends on the part

  std::string_view name;
  std::span<const std::string_view> readers;
  Content content = Content::text;
  /// Splits an input. Damaged bytes may be lost. Returns no parts for another format.
  std::vector<std::string> (*split)(std::string_view) = nullptr;
  std::string (*join)(const std::vector<std::string>&) = nullptr;
};

/// Returns the structure of a reader's inputs: null for plain binary formats.
const Structure* find_structure(std::string_view reader);

/// Returns all structures, for their test.
std::span<const Structure> all_structures();

/// Mutates bytes at random without a structure, like LLVMFuzzerMutate().
using Mutate = std::string (*)(std::string bytes, std::size_t max);

/// Changes one part of the input, or repeats, removes, moves or swaps parts. Text is changed by
/// elements (JSON, XML, YAML blocks, lines) and numbers, other parts by `mutate`.
std::string mutated(const Structure& structure, std::string_view input, std::mt19937& random,
                    std::size_t max, Mutate mutate);

}  // namespace skycap::fuzz
