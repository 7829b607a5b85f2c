#include <cmath>

#include <tbb/parallel_for.h>

#include "output/atomic_file.h"
#include "output/detail/look.h"
#include "output/detail/sequence_checks.h"
#include "output/detail/text_buffer.h"
#include "output/detail/usd_names.h"
#include "output/writers.h"

namespace sunder::output {
namespace {

using detail::TextBuffer;

struct Sample {
  int frame = 0;
  Pose pose;
  Twist twist;
};

// Motion of each piece, in frame numbers.
using Motion = std::vector<Sample>;

std::vector<Motion> motions(const Sequence& sequence) {
  std::vector<Motion> result(sequence.pieces.size());
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    detail::require_finite(sequence, sequence.frames[f]);
    for (const auto& [piece, pose, twist] : sequence.frames[f].poses) {
      Motion& samples = result.at(static_cast<std::size_t>(piece));
      Quat q = pose.orientation.normalized();
      // q and -q are the same rotation, but not what lies between them.
      if (!samples.empty() && samples.back().pose.orientation.dot(q) < 0) q.coeffs() = -q.coeffs();
      samples.push_back({sequence.start_frame + static_cast<int>(f), {pose.position, q}, twist});
    }
  }
  return result;
}

template <class Vector>
void append(TextBuffer& out, const Vector& v) {
  for (int i = 0; i < v.size(); ++i) out << (i == 0 ? "(" : ", ") << v[i];
  out << ")";
}

// "name = [a, b, ...]"
template <class Count, class Item>
void append_list(TextBuffer& out, std::string_view name, Count count, const Item& item,
                 std::string_view metadata = "") {
  out << "            " << name << " = [";
  for (Count i = 0; i < count; ++i) {
    if (i > 0) out << ", ";
    item(i);
  }
  out << "]" << metadata << "\n";
}

constexpr std::string_view kFaceVarying = " (\n                interpolation = \"faceVarying\"\n            )";
constexpr std::string_view kUniform = " (\n                interpolation = \"uniform\"\n            )";

void append_surface(TextBuffer& out, const Piece& piece) {
  const geometry::TriangleMesh& mesh = piece.mesh;
  const geometry::SurfaceAttributes& surface = piece.surface;
  const Box box = geometry::bounds(mesh);
  out << "            uniform token subdivisionScheme = \"none\"\n            float3[] extent = [";
  append(out, Eigen::Vector3f(box.min().cast<float>()));
  out << ", ";
  append(out, Eigen::Vector3f(box.max().cast<float>()));
  out << "]\n";
  const std::size_t faces = mesh.faces.size();
  append_list(out, "int[] faceVertexCounts", faces, [&](std::size_t) { out << "3"; });
  append_list(out, "int[] faceVertexIndices", 3 * faces, [&](std::size_t c) { out << mesh.faces[c / 3][c % 3]; });
  append_list(out, "point3f[] points", mesh.vertices.size(),
              [&](std::size_t v) { append(out, Eigen::Vector3f(mesh.vertices[v].cast<float>())); });
  if (!surface.normal.empty())
    append_list(
        out, "normal3f[] normals", 3 * faces,
        [&](std::size_t c) { append(out, Eigen::Vector3f(surface.normal[c / 3][c % 3].cast<float>())); }, kFaceVarying);
  if (!surface.uv.empty())
    append_list(
        out, "texCoord2f[] primvars:st", 3 * faces,
        [&](std::size_t c) {
          const Eigen::Vector2f uv = surface.uv[c / 3][c % 3].cast<float>();
          out << "(" << uv.x() << ", " << uv.y() << ")";
        },
        kFaceVarying);
  if (!surface.colour.empty())
    append_list(
        out, "color3f[] primvars:displayColor", 3 * faces,
        [&](std::size_t c) { append(out, Eigen::Vector3f(surface.colour[c / 3][c % 3].head<3>().cast<float>())); },
        kFaceVarying);
  if (!surface.damage_time.empty())
    append_list(
        out, "float[] primvars:damage_time", 3 * faces,
        [&](std::size_t c) { out << static_cast<float>(surface.damage_time[c / 3][c % 3]); }, kFaceVarying);
  append_list(
      out, "int[] primvars:source_face", faces, [&](std::size_t f) { out << piece.source_face[f]; }, kUniform);
}

// What lies between two equal samples is the same: only the ends of a rest are written.
template <class Value>
void append_samples(TextBuffer& out, std::string_view name, const Motion& samples, const Value& value) {
  out << "        " << name << ".timeSamples = {\n";
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto here = value(samples[i]);
    const bool inner = i > 0 && i + 1 < samples.size();
    if (inner && here == value(samples[i - 1]) && here == value(samples[i + 1])) continue;
    out << "            " << samples[i].frame << ": ";
    append(out, here);
    out << ",\n";
  }
  out << "        }\n";
}

void append_motion(TextBuffer& out, const Motion& samples) {
  using Eigen::Vector3f, Eigen::Vector4f;
  append_samples(out, "double3 xformOp:translate", samples, [](const Sample& s) { return s.pose.position; });
  append_samples(out, "quatf xformOp:orient", samples, [](const Sample& s) -> Vector4f {
    const Quat& q = s.pose.orientation;
    return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).cast<float>();
  });
  out << "        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]\n";
  // In USD's grammar samples cannot say `custom` themselves.
  out << "        custom vector3f sunder:velocity\n";
  append_samples(out, "vector3f sunder:velocity", samples,
                 [](const Sample& s) -> Vector3f { return s.twist.linear.cast<float>(); });
  out << "        custom vector3f sunder:angularVelocity\n";
  append_samples(out, "vector3f sunder:angularVelocity", samples,
                 [](const Sample& s) -> Vector3f { return s.twist.angular.cast<float>(); });
}

// A piece lives through consecutive frames.
void append_visibility(TextBuffer& out, const Sequence& sequence, const Motion& samples) {
  const int first = sequence.start_frame, last = first + static_cast<int>(sequence.frames.size()) - 1;
  if (samples.empty()) {
    out << "        token visibility = \"invisible\"\n";
    return;
  }
  const int born = samples.front().frame, broke = samples.back().frame + 1;
  if (born == first && broke > last) return;
  out << "        token visibility.timeSamples = {\n";
  if (born > first) out << "            " << first << ": \"invisible\",\n";
  out << "            " << born << ": \"inherited\",\n";
  if (broke <= last) out << "            " << broke << ": \"invisible\",\n";
  out << "        }\n";
}

void append_origin(TextBuffer& out, const Sequence& sequence, const Piece& piece) {
  out << "        custom int sunder:id = " << piece.id << "\n        custom string sunder:name = \"" << piece.name
      << "\"\n        custom string sunder:body = \"" << piece.body
      << "\"\n        custom int sunder:parent = " << piece.parent
      << "\n        custom int sunder:generation = " << piece.generation << "\n        custom int sunder:birthFrame = "
      << frame_at(piece.birth_time, sequence.frame_rate, sequence.start_frame)
      << "\n        custom double sunder:birthTime = " << piece.birth_time
      << "\n        custom string sunder:material = \"" << piece.material
      << "\"\n        custom double sunder:volume = " << piece.volume
      << "\n        custom double sunder:mass = " << piece.mass
      << "\n        custom double sunder:area = " << piece.area
      << "\n        custom double sunder:insideArea = " << piece.inside_area
      << "\n        custom bool sunder:closed = " << static_cast<int>(piece.closed) << "\n";
  if (std::isfinite(piece.death_time)) out << "        custom double sunder:deathTime = " << piece.death_time << "\n";
}

// What a piece needs to know of the file around it.
struct Names {
  std::string root;
  std::string prim;
  std::vector<std::string> materials;  // by the surface's materials
};

void append_bindings(TextBuffer& out, const Piece& piece, const Names& names) {
  const auto bind = [&](std::string_view indent, int material) {
    out << indent << "rel material:binding = </" << names.root << "/Materials/"
        << names.materials[static_cast<std::size_t>(material)] << ">\n";
  };
  const auto groups = detail::faces_by_material(piece);
  if (groups.empty()) return;
  bind("            ", groups.front().material);
  if (groups.size() == 1) return;
  out << "            uniform token subsetFamily:materialBind:familyType = \"partition\"\n";
  for (const auto& [material, faces] : groups) {
    out << "\n            def GeomSubset \"" << names.materials[static_cast<std::size_t>(material)]
        << "\" (\n                prepend apiSchemas = [\"MaterialBindingAPI\"]\n            )\n            {\n"
        << "                uniform token elementType = \"face\"\n"
        << "                uniform token familyName = \"materialBind\"\n    ";
    append_list(out, "int[] indices", faces.size(), [&, &of = faces](std::size_t i) { out << of[i]; });
    bind("                ", material);
    out << "            }\n";
  }
}

std::string piece_text(const Sequence& sequence, const Piece& piece, const Motion& motion, const Names& names) {
  constexpr std::size_t kBytesPerFace = 120, kBytesPerSample = 300;
  TextBuffer out(2000 + kBytesPerFace * piece.mesh.faces.size() + kBytesPerSample * motion.size());
  out << "\n    def Xform \"" << names.prim << "\" (\n        kind = \"component\"\n    )\n    {\n";
  append_origin(out, sequence, piece);
  if (!motion.empty()) append_motion(out, motion);
  append_visibility(out, sequence, motion);
  out << "\n        def Mesh \"mesh\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n        "
         "{\n";
  append_surface(out, piece);
  append_bindings(out, piece, names);
  out << "        }\n    }\n";
  return out.take();
}

void append_materials(TextBuffer& out, const Sequence& sequence, const std::string& root, detail::UsdNames& names) {
  out << "    def Scope \"Materials\"\n    {\n";
  for (const auto& [name, substance] : detail::surface_materials(sequence)) {
    const detail::Look look = detail::look_of(name, substance);
    const std::string& prim = names(name);
    out << "        def Material \"" << prim << "\"\n        {\n            token outputs:surface.connect = </" << root
        << "/Materials/" << prim << "/surface.outputs:surface>\n\n            def Shader \"surface\"\n            {\n"
        << "                uniform token info:id = \"UsdPreviewSurface\"\n"
        << "                color3f inputs:diffuseColor = (" << look.colour[0] << ", " << look.colour[1] << ", "
        << look.colour[2] << ")\n                float inputs:metallic = " << look.metallic
        << "\n                float inputs:roughness = " << look.roughness
        << "\n                token outputs:surface\n            }\n        }\n";
  }
  out << "    }\n";
}

std::string head(const Sequence& sequence, const std::string& root) {
  TextBuffer out(1000);
  const int last = sequence.start_frame + static_cast<int>(sequence.frames.size()) - 1;
  out << "#usda 1.0\n(\n    defaultPrim = \"" << root << "\"\n    endTimeCode = " << last
      << "\n    framesPerSecond = " << sequence.frame_rate
      << "\n    metersPerUnit = 1\n    startTimeCode = " << sequence.start_frame
      << "\n    timeCodesPerSecond = " << sequence.frame_rate << "\n    upAxis = \"Y\"\n)\n\n"
      << "def Xform \"" << root << "\" (\n    kind = \"assembly\"\n)\n{\n";
  return out.take();
}

}  // namespace

void write_usda(const Sequence& sequence, const std::filesystem::path& file) {
  const std::vector<Motion> motion = motions(sequence);
  detail::UsdNames root_name, material_names, prims;
  const std::string root = root_name(sequence.name);
  TextBuffer out(10'000);
  out << head(sequence, root);
  prims("Materials");
  append_materials(out, sequence, root, material_names);
  std::vector<Names> names(sequence.pieces.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = {root, prims(sequence.pieces[i].name), {}};
    for (const std::string& material : sequence.pieces[i].surface.material_names)
      names[i].materials.push_back(material_names(material));
  }
  std::vector<std::string> texts(sequence.pieces.size());
  tbb::parallel_for(std::size_t{0}, texts.size(),
                    [&](std::size_t i) { texts[i] = piece_text(sequence, sequence.pieces[i], motion[i], names[i]); });
  for (const std::string& text : texts) out << text;
  out << "}\n";
  write_atomically(file, out.text());
}

}  // namespace sunder::output
