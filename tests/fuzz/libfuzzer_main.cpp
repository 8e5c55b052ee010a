// Entry point for libFuzzer. The environment selects the reader, for example:
//   FUZZ_READER=mission build/fuzz/tests/fuzz/skycap_fuzz -max_total_time=60 FOUND
//   tests/fuzz/corpus/mission
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

#include "tests/fuzz/readers.h"
#include "tests/fuzz/structure.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t max);

namespace {

skycap::fuzz::Reader reader;
const skycap::fuzz::Structure* structure = nullptr;

std::string mutate_bytes(std::string bytes, std::size_t max) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max(max, size));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("FUZZ_READER");
  if (name != nullptr) reader = skycap::fuzz::find_reader(name);
  if (reader.run != nullptr) {
    structure = skycap::fuzz::find_structure(name);
    return 0;
  }
  std::fputs("FUZZ_READER must name a folder of tests/fuzz/corpus\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return reader.run(bytes, size);
}

/// Mutates three quarters of the inputs by their structure, the others as bytes.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size,
                                               std::size_t max, unsigned seed) {
  std::mt19937 random(seed);
  if (structure == nullptr || random() % 4 == 0) return LLVMFuzzerMutate(bytes, size, max);
  const std::string output = skycap::fuzz::mutated(
      *structure, {reinterpret_cast<const char*>(bytes), size}, random, max, mutate_bytes);
  std::memcpy(bytes, output.data(), output.size());
  return output.size();
}
