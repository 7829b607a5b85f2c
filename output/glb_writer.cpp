#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>

#include "core/error.h"
#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/tracks.h"
#include "output/detail/vertex_arrays.h"
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

// A white pixel as PNG (grey, 8 bits). Where a surface has texture coordinates its material has this texture: a place
// for the artist's own, and without a texture validators call the coordinates unused.
constexpr std::array<unsigned char, 67> kWhitePixel = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0x0f, 0x00, 0x01, 0x01, 0x01, 0x00,
    0x1c, 0xb0, 0x8c, 0x99, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

// The double that is printed with the digits of the float and no more. It rounds to the same float.
double short_double(float value) {
  std::array<char, 32> digits;
  const char* end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  double result = 0;
  std::from_chars(digits.data(), end, result);
  return result;
}

template <class Values>
std::vector<double> short_doubles(const Values& values) {
  std::vector<double> result;
  for (const float value : values) result.push_back(short_double(value));
  return result;
}

class Builder {
 public:
  explicit Builder(const Sequence& sequence) : sequence_(sequence) {
    for (View* view : {&positions_, &normals_, &uvs_, &colours_, &damage_times_})
      view->target = TINYGLTF_TARGET_ARRAY_BUFFER;
    positions_.stride = normals_.stride = 3 * sizeof(float);
    uvs_.stride = 2 * sizeof(float);
    colours_.stride = 4 * sizeof(float);
    damage_times_.stride = sizeof(float);
    indices_.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
  }

  tinygltf::Model build() {
    model_.asset.version = "2.0";
    model_.asset.generator = "Sunder";
    const std::vector<detail::Track> tracks = detail::tracks(sequence_);
    textured_ = textured_materials(sequence_);
    model_.scenes.resize(1);
    model_.scenes[0].name = sequence_.name;
    model_.defaultScene = 0;
    for (std::size_t i = 0; i < tracks.size(); ++i) add_piece(sequence_.pieces[i], tracks[i]);
    if (!animation_.channels.empty()) model_.animations.push_back(animation_);
    finish_buffer();
    return std::move(model_);
  }

 private:
  static std::set<std::string> textured_materials(const Sequence& sequence) {
    std::set<std::string> names;
    for (const Piece& piece : sequence.pieces)
      for (const auto& [material, faces] : detail::faces_by_material(piece))
        if (detail::has_texture(piece, faces))
          names.insert(piece.surface.material_names[static_cast<std::size_t>(material)]);
    return names;
  }

  int white_texture() {
    if (!model_.textures.empty()) return 0;
    image_.bytes.assign(kWhitePixel.begin(), kWhitePixel.end());
    image_.index = view_count_++;
    tinygltf::Image image;
    image.name = "white";
    image.mimeType = "image/png";
    image.bufferView = image_.index;
    model_.images.push_back(image);
    tinygltf::Texture texture;
    texture.source = 0;
    model_.textures.push_back(texture);
    return 0;
  }

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
    if (textured_.contains(name)) added.pbrMetallicRoughness.baseColorTexture.index = white_texture();
    model_.materials.push_back(added);
    return entry->second;
  }

  // Appends values to the view as a new accessor and returns its index.
  template <class T>
  int add_accessor(View& view, std::span<const T> values, int component, int type, std::size_t width) {
    if (view.index < 0) view.index = view_count_++;
    tinygltf::Accessor accessor;
    accessor.bufferView = view.index;
    accessor.byteOffset = view.bytes.size();
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size() / width;
    view.bytes.resize(accessor.byteOffset + values.size_bytes());
    std::memcpy(view.bytes.data() + accessor.byteOffset, values.data(), values.size_bytes());
    view.bytes.resize((view.bytes.size() + 3) / 4 * 4);  // accessors start at multiples of their components' size
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_positions(const geometry::TriangleMesh& mesh, const std::vector<int>& vertices) {
    std::vector<float> values;
    values.reserve(3 * vertices.size());
    Eigen::AlignedBox3f box;
    for (const int vertex : vertices) {
      const Eigen::Vector3f x = mesh.vertices[static_cast<std::size_t>(vertex)].cast<float>();
      box.extend(x);
      values.insert(values.end(), x.data(), x.data() + 3);
    }
    const int index = add_accessor<float>(positions_, values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3);
    tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    accessor.minValues = short_doubles(box.min());
    accessor.maxValues = short_doubles(box.max());
    return index;
  }

  template <class Index>
  int add_indices(const std::vector<std::uint32_t>& corners, int component) {
    const std::vector<Index> values(corners.begin(), corners.end());
    return add_accessor<Index>(indices_, values, component, TINYGLTF_TYPE_SCALAR, 1);
  }

  void add_attributes(tinygltf::Primitive& primitive, detail::VertexArrays& arrays) {
    constexpr int kFloat = TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (!arrays.normal.empty())
      primitive.attributes["NORMAL"] =
          add_accessor<float>(normals_, flat(arrays.normal), kFloat, TINYGLTF_TYPE_VEC3, 3);
    if (!arrays.uv.empty()) {
      for (auto& uv : arrays.uv) uv[1] = 1 - uv[1];  // glTF's v points down the picture
      primitive.attributes["TEXCOORD_0"] = add_accessor<float>(uvs_, flat(arrays.uv), kFloat, TINYGLTF_TYPE_VEC2, 2);
    }
    if (!arrays.colour.empty())
      primitive.attributes["COLOR_0"] =
          add_accessor<float>(colours_, flat(arrays.colour), kFloat, TINYGLTF_TYPE_VEC4, 4);
    if (!arrays.damage_time.empty())
      primitive.attributes["_DAMAGE_TIME"] =
          add_accessor<float>(damage_times_, arrays.damage_time, kFloat, TINYGLTF_TYPE_SCALAR, 1);
  }

  void add_primitive(tinygltf::Mesh& mesh, const Piece& piece, const detail::MaterialFaces& group) {
    const std::string& name = piece.surface.material_names[static_cast<std::size_t>(group.material)];
    detail::VertexArrays arrays = detail::vertex_arrays(piece, group.faces, textured_.contains(name));
    tinygltf::Primitive primitive;
    primitive.attributes["POSITION"] = add_positions(piece.mesh, arrays.vertex);
    add_attributes(primitive, arrays);
    // 65535 itself is reserved (primitive restart).
    primitive.indices = arrays.vertex.size() <= 65535
                            ? add_indices<std::uint16_t>(arrays.corner, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
                            : add_indices<std::uint32_t>(arrays.corner, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    primitive.material = material(name, piece.material);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    mesh.primitives.push_back(primitive);
  }

  // -1 for a piece without faces: a glTF mesh cannot be empty.
  int add_mesh(const Piece& piece) {
    if (piece.mesh.faces.empty()) return -1;
    tinygltf::Mesh mesh;
    mesh.name = piece.name;
    for (const detail::MaterialFaces& group : detail::faces_by_material(piece)) add_primitive(mesh, piece, group);
    model_.meshes.push_back(mesh);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  tinygltf::Value extras(const Piece& piece) const {
    using tinygltf::Value;
    Value::Object object = {
        {"id", Value(piece.id)},
        {"body", Value(piece.body)},
        {"parent", Value(piece.parent)},
        {"generation", Value(piece.generation)},
        {"birth_time", Value(piece.birth_time)},
        {"birth_frame", Value(frame_at(piece.birth_time, sequence_.frame_rate, sequence_.start_frame))},
        {"material", Value(piece.material)},
        {"volume", Value(piece.volume)},
        {"mass", Value(piece.mass)},
        {"area", Value(piece.area)},
        {"inside_area", Value(piece.inside_area)},
        {"closed", Value(piece.closed)}};
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
      node.translation = short_doubles(track.translations.front());
      node.rotation = short_doubles(track.rotations.front());
    }
    if (track.visible.empty() || track.visible.front() == 0) node.scale = {0, 0, 0};
    const int index = static_cast<int>(model_.nodes.size());
    model_.nodes.push_back(node);
    model_.scenes[0].nodes.push_back(index);
    animate(index, track);
  }

  void animate(int node, const detail::Track& track) {
    add_motion(node, "translation", track.times, track.translations, TINYGLTF_TYPE_VEC3);
    add_motion(node, "rotation", track.times, track.rotations, TINYGLTF_TYPE_VEC4);
    if (varies(track.visible)) {
      add_channel(node, "scale", track.switch_times, scales_accessor(track.visible), "STEP");
    }
  }

  // What lies between two equal keys is the same however it is interpolated: only the ends of a rest are written.
  template <class Value>
  void add_motion(int node, const char* path, const std::vector<float>& times, const std::vector<Value>& values,
                  int type) {
    if (!varies(values)) return;
    std::vector<float> kept_times;
    std::vector<Value> kept;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0 && i + 1 < values.size() && values[i] == values[i - 1] && values[i] == values[i + 1]) continue;
      kept_times.push_back(times[i]);
      kept.push_back(values[i]);
    }
    const int output = add_accessor<float>(motion_, flat(kept), TINYGLTF_COMPONENT_TYPE_FLOAT, type, kept[0].size());
    add_channel(node, path, kept_times, output, "LINEAR");
  }

  template <class Values>
  static bool varies(const Values& values) {
    return std::any_of(values.begin(), values.end(), [&](const auto& value) { return value != values.front(); });
  }

  template <class Array>
  static std::vector<float> flat(const std::vector<Array>& values) {
    std::vector<float> result;
    result.reserve(values.size() * std::tuple_size_v<Array>);
    for (const Array& value : values) result.insert(result.end(), value.begin(), value.end());
    return result;
  }

  void add_channel(int node, const char* path, const std::vector<float>& times, int output, const char* interpolation) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times_accessor(times);
    sampler.output = output;
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
    accessor.minValues = {short_double(times.front())};
    accessor.maxValues = {short_double(times.back())};
    return entry->second;
  }

  // Nearly all pieces appear and stay.
  int scales_accessor(const std::vector<float>& visible) {
    const auto [entry, is_new] = scales_index_.try_emplace(visible, -1);
    if (!is_new) return entry->second;
    std::vector<float> scales;
    for (const float scale : visible) scales.insert(scales.end(), 3, scale);
    return entry->second = add_accessor<float>(motion_, scales, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3);
  }

  void finish_buffer() {
    model_.bufferViews.resize(static_cast<std::size_t>(view_count_));
    tinygltf::Buffer buffer;
    for (const View* view : {&positions_, &normals_, &uvs_, &colours_, &damage_times_, &indices_, &motion_, &image_}) {
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
  View positions_, normals_, uvs_, colours_, damage_times_, indices_, motion_, image_;
  int view_count_ = 0;
  std::set<std::string> textured_;  // names of materials
  std::map<std::string, int> material_index_;
  std::map<std::vector<float>, int> times_index_, scales_index_;
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
