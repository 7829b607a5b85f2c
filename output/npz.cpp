#include "output/npz.h"

#include <cassert>
#include <memory>
#include <numeric>

#include <zip.h>

#include "core/error.h"

namespace sunder::output {
namespace {

constexpr std::size_t kAlignment = 64;  // of the data, by the NPY format
constexpr int kCompression = 6;         // of 9

/// An array as an NPY file of version 1.0.
std::string npy(const char* type, std::initializer_list<std::size_t> shape, const void* values, std::size_t bytes) {
  std::string dimensions;
  for (const std::size_t extent : shape) dimensions.append(std::to_string(extent)).append(",");
  std::string header =
      std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" + dimensions + "), }";
  constexpr std::size_t kBefore = 10;  // magic, version, length
  header.append((kAlignment - (kBefore + header.size() + 1) % kAlignment) % kAlignment, ' ').append("\n");
  std::string file("\x93NUMPY\x01\x00", 8);
  file.push_back(static_cast<char>(header.size() & 0xff));
  file.push_back(static_cast<char>(header.size() >> 8));
  return file.append(header).append(static_cast<const char*>(values), bytes);
}

template <typename T>
std::string npy_of(const char* type, std::initializer_list<std::size_t> shape, std::span<const T> values) {
  assert(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()) == values.size());
  return npy(type, shape, values.data(), values.size_bytes());
}

void require(bool done) {
  if (!done) throw Error(ErrorKind::internal, "arrays could not be compressed; is there memory left?");
}

struct FreeSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};

std::string content(zip_source_t* source) {
  zip_stat_t status;
  require(zip_source_stat(source, &status) == 0 && zip_source_open(source) == 0);
  std::string bytes(status.size, '\0');
  const bool whole = zip_source_read(source, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size());
  zip_source_close(source);
  require(whole);
  return bytes;
}

}  // namespace

void Npz::add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const float> values) {
  members_.push_back({name + ".npy", npy_of("<f4", shape, values)});
}

void Npz::add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const double> values) {
  members_.push_back({name + ".npy", npy_of("<f8", shape, values)});
}

void Npz::add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const std::int32_t> values) {
  members_.push_back({name + ".npy", npy_of("<i4", shape, values)});
}

void Npz::add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const std::uint8_t> values) {
  members_.push_back({name + ".npy", npy_of("|u1", shape, values)});
}

std::string Npz::bytes() const {
  const std::unique_ptr<zip_source_t, FreeSource> buffer(zip_source_buffer_create(nullptr, 0, 0, nullptr));
  require(buffer != nullptr);
  zip_source_keep(buffer.get());  // closing the archive gives up one of the two holds
  zip_t* archive = zip_open_from_source(buffer.get(), ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) zip_source_free(buffer.get());
  require(archive != nullptr);
  bool done = true;
  for (const Member& member : members_) {
    zip_source_t* data = zip_source_buffer(archive, member.data.data(), member.data.size(), 0);
    const zip_int64_t index = data == nullptr ? -1 : zip_file_add(archive, member.name.c_str(), data, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(data);
    // Beginning of the calendar of zip files: the time of writing would make files differ.
    done = done && index >= 0 &&
           zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE, kCompression) == 0 &&
           zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, (1 << 5) | 1, 0) == 0;
  }
  done = zip_close(archive) == 0 && done;
  if (!done) zip_discard(archive);
  require(done);
  return content(buffer.get());
}

}  // namespace sunder::output
