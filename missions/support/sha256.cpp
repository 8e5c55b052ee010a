#include "missions/support/sha256.h"

#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::missions::support {

namespace {

void require_success(int result) {
  if (result != 1) throw std::runtime_error("the cryptography library does not support SHA-256");
}

/// Returns the algorithm from a separate library context. When memory is low, OpenSSL 3.0 crashes
/// because it uses a default context that was not created.
const EVP_MD* algorithm() {
  static const std::unique_ptr<OSSL_LIB_CTX, decltype(&OSSL_LIB_CTX_free)> library(
      OSSL_LIB_CTX_new(), OSSL_LIB_CTX_free);
  if (!library) throw std::bad_alloc();
  static const std::unique_ptr<EVP_MD, decltype(&EVP_MD_free)> sha256(
      EVP_MD_fetch(library.get(), "SHA256", nullptr), EVP_MD_free);
  if (!sha256) throw std::bad_alloc();
  return sha256.get();
}

/// Computes the SHA-256 incrementally.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_) throw std::bad_alloc();
    require_success(EVP_DigestInit_ex(context_.get(), algorithm(), nullptr));
  }

  void add(std::span<const std::byte> bytes) {
    require_success(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
  }

  std::string finish() {
    std::array<unsigned char, 32> digest{};
    require_success(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
    std::string text;
    constexpr char digits[] = "0123456789abcdef";
    for (const unsigned char byte : digest) {
      text += digits[byte >> 4];
      text += digits[byte & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256(std::span<const std::byte> bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.finish();
}

std::string compute_file_sha256(const std::filesystem::path& file) {
  std::ifstream stream = geometry::open_stream(file);
  Sha256 sum;
  std::vector<char> chunk(std::size_t{1} << 18);
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())),
         stream.gcount() > 0) {
    sum.add(std::as_bytes(std::span(chunk).first(static_cast<std::size_t>(stream.gcount()))));
  }
  if (!stream.eof()) throw Error(ErrorKind::bad_file, file.string() + ": cannot be read");
  return sum.finish();
}

}  // namespace skycap::missions::support
