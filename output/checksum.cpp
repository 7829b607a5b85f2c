#include "output/checksum.h"

#include <array>
#include <cerrno>
#include <fstream>
#include <memory>
#include <system_error>

#include <openssl/evp.h>

#include "core/error.h"

namespace sunder::output {

std::string sha256_of_file(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& why) { throw Error(ErrorKind::io, file.string() + ": " + why); };
  std::ifstream in(file, std::ios::binary);
  if (!in) fail("cannot be read: " + std::generic_category().message(errno));
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  bool done = digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) == 1;
  std::array<char, 1 << 16> piece;
  while (done && in.read(piece.data(), piece.size()).gcount() > 0)
    done = EVP_DigestUpdate(digest.get(), piece.data(), static_cast<std::size_t>(in.gcount())) == 1;
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes;
  unsigned length = 0;
  done = done && EVP_DigestFinal_ex(digest.get(), bytes.data(), &length) == 1;
  if (!done || in.bad()) fail("no checksum could be made");
  std::string digits;
  for (unsigned i = 0; i < length; ++i) {
    digits.push_back("0123456789abcdef"[bytes[i] >> 4]);
    digits.push_back("0123456789abcdef"[bytes[i] & 15]);
  }
  return digits;
}

}  // namespace sunder::output
