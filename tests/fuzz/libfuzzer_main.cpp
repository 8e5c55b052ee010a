// Entry point for libFuzzer. The environment selects the reader, for example:
//   FUZZ_READER=mission build/fuzz/tests/fuzz/skycap_fuzz -max_total_time=60 FOUND
//   tests/fuzz/corpus/mission
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/readers.h"

namespace {

skycap::fuzz::Reader reader;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("FUZZ_READER");
  if (name != nullptr) reader = skycap::fuzz::find_reader(name);
  if (reader.run != nullptr) return 0;
  std::fputs("FUZZ_READER must name a folder of tests/fuzz/corpus\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return reader.run(bytes, size);
}
