#include "pipeline/checkpoint.h"

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/hash.h"
#include "output/atomic_file.h"
#include "pipeline/detail/archive.h"
#include "pipeline/version.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

const std::string magic = "sunder checkpoint 2\n";
const std::string build = build_name();

/// Digits of the hash of all before them end the file.
constexpr std::size_t digits_size = 16;

/// Hands on what it is given.
class HashingBuffer : public std::streambuf {
 public:
  explicit HashingBuffer(std::streambuf& to) : to_(to) {}
  std::string digits() const { return hash_.digits(); }

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    hash_.add({bytes, static_cast<std::size_t>(size)});
    return to_.sputn(bytes, size);
  }
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }

  std::streambuf& to_;
  Hash hash_;
};

[[noreturn]] void damaged(const fs::path& file, const std::string& what) {
  throw Error(ErrorKind::io, file.string() + ": " + what + "; run without --resume to start again");
}

bool is_whole(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream all(std::ios::binary);
  all << in.rdbuf();
  const std::string_view bytes = all.view();
  if (bytes.size() < digits_size) return false;
  const std::size_t end = bytes.size() - digits_size;
  Hash hash;
  hash.add(bytes.substr(0, end));
  return bytes.substr(end) == hash.digits();
}

/// What stands before the state.
struct Header {
  std::string build, scene;
};

template <class Archive>
void serialize(Archive& archive, Header& header) {
  archive(header.build, header.scene);
}

}  // namespace

void write_checkpoint(const fs::path& file, const std::string& scene_fingerprint, int steps,
                      const Simulation& simulation) {
  output::write_atomically(file, [&](std::ostream& out) {
    HashingBuffer hashed(*out.rdbuf());
    std::ostream body(&hashed);
    body << magic;
    cereal::BinaryOutputArchive archive(body);
    archive(Header{build, scene_fingerprint}, steps, simulation.world_state(), simulation.state());
    out << hashed.digits();
  });
}

std::optional<Checkpoint> read_checkpoint(const fs::path& file, const std::string& scene_fingerprint) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::string first(magic.size(), '\0');
  if (!in.read(first.data(), static_cast<std::streamsize>(first.size())) || first != magic)
    damaged(file, "not a checkpoint of this version");
  if (!is_whole(file)) damaged(file, "the checkpoint is damaged");
  try {
    Header header;
    cereal::BinaryInputArchive archive(in);
    archive(header);
    if (header.build != build)
      throw Error(ErrorKind::usage, file.string() + ": the checkpoint is of build " + header.build + ", this is " +
                                        build + "; resume with that one, or run without --resume to start again");
    if (header.scene != scene_fingerprint)
      throw Error(ErrorKind::usage, file.string() +
                                        ": the checkpoint is of another scene, or the scene, a mesh, the seed or the "
                                        "quality has changed since; run without --resume to start again");
    Checkpoint checkpoint;
    archive(checkpoint.steps, checkpoint.world, checkpoint.simulation);
    return checkpoint;
  } catch (const cereal::Exception&) {
    damaged(file, "the checkpoint is damaged");
  }
}

}  // namespace sunder::pipeline
