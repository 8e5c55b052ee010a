#include "missions/scene/sha256.h"

#include <array>
#include <cstddef>
#include <fstream>
#include <vector>

#include <openssl/evp.h>

#include "geometry/error.h"

namespace skycap::missions::scene {

std::string sha256(std::span<const std::byte> bytes) {
  std::array<unsigned char, 32> digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("the cryptography library cannot compute SHA-256");
  }
  std::string text;
  constexpr char digits[] = "0123456789abcdef";
  for (const unsigned char byte : digest) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::bad_file, file.string() + ": cannot be read");
  const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
  return sha256(std::as_bytes(std::span(content)));
}

}  // namespace skycap::missions::scene
