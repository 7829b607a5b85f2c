#include "geometry/detail/packed_mesh.h"

#include <cassert>
#include <cstdint>
#include <cstring>

namespace sunder::geometry::detail {
namespace {

class Writer {
 public:
  template <typename T>
  void operator()(const std::vector<T>& list) {
    (*this)(list.size());
    bytes_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
  }
  void operator()(const std::vector<std::string>& list) {
    (*this)(list.size());
    for (const std::string& text : list) (*this)(std::vector<char>(text.begin(), text.end()));
  }
  void operator()(std::size_t number) { bytes_.append(reinterpret_cast<const char*>(&number), sizeof number); }
  void operator()(double number) { bytes_.append(reinterpret_cast<const char*>(&number), sizeof number); }
  void operator()(UpAxis axis) { (*this)(static_cast<std::size_t>(axis)); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  void operator()(std::vector<T>& list) {
    list.resize(size());
    take(list.data(), list.size() * sizeof(T));
  }
  void operator()(std::vector<std::string>& list) {
    list.resize(size());
    for (std::string& text : list) {
      text.resize(size());
      take(text.data(), text.size());
    }
  }
  void operator()(double& number) { take(&number, sizeof number); }
  void operator()(UpAxis& axis) { axis = static_cast<UpAxis>(size()); }

 private:
  std::size_t size() {
    std::size_t number = 0;
    take(&number, sizeof number);
    return number;
  }
  void take(void* to, std::size_t count) {
    assert(count <= bytes_.size());
    if (count > 0) std::memcpy(to, bytes_.data(), count);
    bytes_.remove_prefix(count);
  }
  std::string_view bytes_;
};

template <typename Mesh, typename Archive>
void visit(Mesh& textured, Archive&& archive) {
  archive(textured.mesh.vertices);
  archive(textured.mesh.faces);
  auto& attributes = textured.attributes;
  archive(attributes.uv);
  archive(attributes.normal);
  archive(attributes.material);
  archive(attributes.material_names);
  archive(attributes.colour);
  archive(attributes.damage_time);
  archive(textured.metres_per_unit);
  archive(textured.up);
}

}  // namespace

std::string packed(const TexturedMesh& mesh) {
  Writer writer;
  visit(mesh, writer);
  return writer.take();
}

TexturedMesh unpacked(std::string_view bytes) {
  TexturedMesh mesh;
  visit(mesh, Reader(bytes));
  return mesh;
}

}  // namespace sunder::geometry::detail
