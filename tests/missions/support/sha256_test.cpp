#include "missions/support/sha256.h"

#include <span>
#include <string>

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::support {
namespace {

std::string checksum(const std::string& text) { return sha256(std::as_bytes(std::span(text))); }

// Examples of FIPS 180-4, published by NIST. The last is longer than the parts in which files are
// read.
TEST(Sha256, MatchesPublishedExamples) {
  const testing_support::TemporaryFolder folder;
  const std::string million(1'000'000, 'a');
  const std::string digest = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
  EXPECT_EQ(checksum("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(checksum(million), digest);
  geometry::write_file(folder.path() / "million", million);
  EXPECT_EQ(compute_file_sha256(folder.path() / "million"), digest);
}

TEST(Sha256, RejectsMissingFile) { EXPECT_THROW(compute_file_sha256("does/not/exist"), Error); }

}  // namespace
}  // namespace skycap::missions::support
