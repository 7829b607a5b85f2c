#include "output/image.h"

#include <cassert>

#include <png.h>

#include "core/error.h"

namespace sunder::output {

std::string to_png(const Image& image) {
  assert(!image.pixels.empty() &&
         image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr))
    throw Error(ErrorKind::internal, std::string("the picture could not be encoded: ") + header.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace sunder::output
