#include "missions/report/script_text.h"

#include <algorithm>
#include <charconv>
#include <new>
#include <span>
#include <stdexcept>

#include <openssl/evp.h>
#include <zlib.h>

#include "missions/support/sha256.h"

namespace skycap::missions::report {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string script_json(const nlohmann::ordered_json& json) {
  std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  replace_all(text, "\u2028", "\\u2028");
  replace_all(text, "\u2029", "\\u2029");
  return text;
}

std::string deflated(std::string_view bytes, Repetition repetition) {
  // Level 9 takes three times as long as level 6 and reduces the size by 1% only.
  constexpr int level = 6, max_memory = 9;
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS, max_memory,
                   repetition == Repetition::runs ? Z_RLE : Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int error = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (error != Z_STREAM_END) throw std::runtime_error("zlib cannot compress");
  return packed;
}

std::string base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // OpenSSL appends a zero
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                  reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

std::string policy_hash(std::string_view text) {
  const std::string hexadecimal = support::sha256(std::as_bytes(std::span(text)));
  std::string digest;
  for (std::size_t i = 0; i < hexadecimal.size(); i += 2) {
    unsigned byte = 0;
    std::from_chars(&hexadecimal[i], &hexadecimal[i] + 2, byte, 16);
    digest += static_cast<char>(byte);
  }
  return "'sha256-" + base64(digest) + "'";
}

}  // namespace skycap::missions::report
