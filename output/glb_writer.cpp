#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <sstream>
#include <string>

#include "core/error.h"
#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/tracks.h"
#include "output/writers.h"

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace sunder::output {
namespace {

// A run of bytes of the file's one buffer that accessors of one kind share.
struct View {
  std::vector<unsigned char> bytes;
  int target = 0;  // what a graphics card uses it for; 0: nothing
  int stride = 0;  // vertex attributes that share a view must state theirs
  int index = -1;  // in the file; given at the first use, so that an unused view never appears
};

class Builder {
 public:
  explicit Builder(const Sequence& sequence) : sequence_(sequence) {
    positions_.target = TINYGLTF_TARGET_ARRAY_BUFFER;
    positions_.stride = 3 * sizeof(float);
    indices_.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
  }

  tinygltf::Model build() {
    model_.asset.version = "2.0";
    model_.asset.generator = "Sunder";
    const std::vector<detail::Track> tracks = detail::tracks(sequence_);
    model_.scenes.resize(1);
    model_.scenes[0].name = sequence_.name;
    model_.defaultScene = 0;
    for (std::size_t i = 0; i < tracks.size(); ++i) add_piece(sequence_.pieces[i], tracks[i]);
    if (!animation_.channels.empty()) model_.animations.push_back(animation_);
    finish_buffer();
    return std::move(model_);
  }

 private:
  // Added when first used: validators complain of materials that nothing wears.
  int material(const std::string& name, const std::string& substance) {
    const auto [entry, is_new] = material_index_.try_emplace(name, static_cast<int>(model_.materials.size()));
    if (!is_new) return entry->second;
    const detail::Look look = detail::look_of(name, substance);
    tinygltf::Material added;
    added.name = name;
    added.pbrMetallicRoughness.baseColorFactor = {look.colour[0], look.colour[1], look.colour[2], 1};
    added.pbrMetallicRoughness.metallicFactor = look.metallic;
    added.pbrMetallicRoughness.roughnessFactor = look.roughness;
    model_.materials.push_back(added);
    return entry->second;
  }

  // Appends values to the view as a new accessor and returns its index.
  template <class T>
  int add_accessor(View& view, std::span<const T> values, int component, int type, int width) {
    if (view.index < 0) view.index = view_count_++;
    tinygltf::Accessor accessor;
    accessor.bufferView = view.index;
    accessor.byteOffset = view.bytes.size();
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size() / static_cast<std::size_t>(width);
    view.bytes.resize(accessor.byteOffset + values.size_bytes());
    std::memcpy(view.bytes.data() + accessor.byteOffset, values.data(), values.size_bytes());
    view.bytes.resize((view.bytes.size() + 3) / 4 * 4);  // accessors start at multiples of their components' size
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_positions(const geometry::TriangleMesh& mesh) {
    std::vector<float> values;
    values.reserve(3 * mesh.vertices.size());
    Eigen::AlignedBox3f box;
    for (const Vec3& vertex : mesh.vertices) {
      const Eigen::Vector3f x = vertex.cast<float>();
      box.extend(x);
      values.insert(values.end(), x.data(), x.data() + 3);
    }
    const int index = add_accessor<float>(positions_, values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3);
    tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    accessor.minValues = {box.min().x(), box.min().y(), box.min().z()};
    accessor.maxValues = {box.max().x(), box.max().y(), box.max().z()};
    return index;
  }

  template <class Index>
  int add_indices(const Piece& piece, const std::vector<int>& faces, int component) {
    std::vector<Index> values;
    values.reserve(3 * faces.size());
    for (const int f : faces) {
      const geometry::Triangle& face = piece.mesh.faces[static_cast<std::size_t>(f)];
      values.insert(values.end(), face.begin(), face.end());
    }
    return add_accessor<Index>(indices_, values, component, TINYGLTF_TYPE_SCALAR, 1);
  }

  void add_primitive(tinygltf::Mesh& mesh, const Piece& piece, int positions, const detail::MaterialFaces& group) {
    tinygltf::Primitive primitive;
    primitive.attributes["POSITION"] = positions;
    // 65535 itself is reserved (primitive restart).
    primitive.indices = piece.mesh.vertices.size() <= 65535
                            ? add_indices<std::uint16_t>(piece, group.faces, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
                            : add_indices<std::uint32_t>(piece, group.faces, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    primitive.material =
        material(piece.surface.material_names[static_cast<std::size_t>(group.material)], piece.material);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    mesh.primitives.push_back(primitive);
  }

  // -1 for a piece without faces: a glTF mesh cannot be empty.
  int add_mesh(const Piece& piece) {
    if (piece.mesh.faces.empty()) return -1;
    tinygltf::Mesh mesh;
    mesh.name = piece.name;
    const int positions = add_positions(piece.mesh);
    for (const detail::MaterialFaces& group : detail::faces_by_material(piece))
      add_primitive(mesh, piece, positions, group);
    model_.meshes.push_back(mesh);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  static tinygltf::Value extras(const Piece& piece) {
    using tinygltf::Value;
    Value::Object object = {{"id", Value(piece.id)},
                            {"body", Value(piece.body)},
                            {"parent", Value(piece.parent)},
                            {"generation", Value(piece.generation)},
                            {"birth_time", Value(piece.birth_time)},
                            {"volume", Value(piece.volume)},
                            {"mass", Value(piece.mass)}};
    if (std::isfinite(piece.death_time)) object["death_time"] = Value(piece.death_time);
    return Value(object);
  }

  // The node's own transform is the piece's state at the first frame, for viewers that play no animation.
  void add_piece(const Piece& piece, const detail::Track& track) {
    tinygltf::Node node;
    node.name = piece.name;
    node.mesh = add_mesh(piece);
    node.extras = extras(piece);
    if (!track.times.empty()) {
      node.translation.assign(track.translations.front().begin(), track.translations.front().end());
      node.rotation.assign(track.rotations.front().begin(), track.rotations.front().end());
    }
    if (track.visible.empty() || track.visible.front() == 0) node.scale = {0, 0, 0};
    const int index = static_cast<int>(model_.nodes.size());
    model_.nodes.push_back(node);
    model_.scenes[0].nodes.push_back(index);
    animate(index, track);
  }

  void animate(int node, const detail::Track& track) {
    if (varies(track.translations)) {
      add_channel(node, "translation", track.times, flat(track.translations), TINYGLTF_TYPE_VEC3, 3, "LINEAR");
    }
    if (varies(track.rotations)) {
      add_channel(node, "rotation", track.times, flat(track.rotations), TINYGLTF_TYPE_VEC4, 4, "LINEAR");
    }
    if (varies(track.visible)) {
      std::vector<float> scales;
      for (const float visible : track.visible) scales.insert(scales.end(), 3, visible);
      add_channel(node, "scale", track.switch_times, scales, TINYGLTF_TYPE_VEC3, 3, "STEP");
    }
  }

  template <class Values>
  static bool varies(const Values& values) {
    return std::any_of(values.begin(), values.end(), [&](const auto& value) { return value != values.front(); });
  }

  template <class Array>
  static std::vector<float> flat(const std::vector<Array>& values) {
    std::vector<float> result;
    for (const Array& value : values) result.insert(result.end(), value.begin(), value.end());
    return result;
  }

  void add_channel(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
                   int type, int width, const char* interpolation) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times_accessor(times);
    sampler.output = add_accessor<float>(motion_, values, TINYGLTF_COMPONENT_TYPE_FLOAT, type, width);
    sampler.interpolation = interpolation;
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(animation_.samplers.size());
    channel.target_node = node;
    channel.target_path = path;
    animation_.samplers.push_back(sampler);
    animation_.channels.push_back(channel);
  }

  // Pieces that live through the same frames share their times.
  int times_accessor(const std::vector<float>& times) {
    const auto [entry, is_new] = times_index_.try_emplace(times, -1);
    if (!is_new) return entry->second;
    entry->second = add_accessor<float>(motion_, times, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 1);
    tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(entry->second)];
    accessor.minValues = {times.front()};
    accessor.maxValues = {times.back()};
    return entry->second;
  }

  void finish_buffer() {
    model_.bufferViews.resize(static_cast<std::size_t>(view_count_));
    tinygltf::Buffer buffer;
    for (const View* view : {&positions_, &indices_, &motion_}) {
      if (view->index < 0) continue;
      tinygltf::BufferView& target = model_.bufferViews[static_cast<std::size_t>(view->index)];
      target.buffer = 0;
      target.byteOffset = buffer.data.size();
      target.byteLength = view->bytes.size();
      target.byteStride = static_cast<std::size_t>(view->stride);
      target.target = view->target;
      buffer.data.insert(buffer.data.end(), view->bytes.begin(), view->bytes.end());
    }
    if (!buffer.data.empty()) model_.buffers.push_back(std::move(buffer));
  }

  const Sequence& sequence_;
  tinygltf::Model model_;
  tinygltf::Animation animation_;
  View positions_, indices_, motion_;
  int view_count_ = 0;
  std::map<std::string, int> material_index_;
  std::map<std::vector<float>, int> times_index_;
};

}  // namespace

void write_glb(const Sequence& sequence, const std::filesystem::path& file) {
  for (const Frame& frame : sequence.frames) detail::require_finite(sequence, frame);
  const tinygltf::Model model = Builder(sequence).build();
  // The format counts its bytes in 32 bits; the rest of that room is for the JSON part.
  constexpr std::size_t kMaximumBuffer = 4'000'000'000;
  if (!model.buffers.empty() && model.buffers[0].data.size() > kMaximumBuffer) {
    throw Error(ErrorKind::io, "cannot write " + file.string() +
                                   ": binary glTF holds at most 4 GB; lower the frame rate or write OBJ only");
  }
  std::ostringstream bytes;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, false, true);
  write_atomically(file, bytes.view());
}

}  // namespace sunder::output
