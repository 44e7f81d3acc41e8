// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <new>
#include <string_view>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text_lines.h"
#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/defects.h"
#include "renderfarm/scene/environment_file.h"
#include "renderfarm/scene/found_frame.h"
#include "renderfarm/scene/found_light.h"
#include "renderfarm/scene/found_settings.h"
#include "renderfarm/scene/scene_package.h"
#include "renderfarm/scene/spz.h"
#include "renderfarm/scene/thin_glass.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kPackageLimitBytes = std::size_t{1} << 20;

enum class Format { kGltf, kPly, kObj, kLas, kE57, kSpz, kPackage };

Result<Format> format_of(const std::filesystem::path& path) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  const std::string_view text(reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size());
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (text.empty()) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is empty; copy it again", path.string()));
  }
  if (text.starts_with("glTF")) return Format::kGltf;
  if (text.starts_with("LASF")) return Format::kLas;
  if (text.starts_with("ASTM-E57")) return Format::kE57;
  if (text.starts_with("ply") && text.find_first_of("\r\n") == 3) return Format::kPly;
  if (extension == ".glb" || extension == ".gltf") return Format::kGltf;
  if (extension == ".ply") return Format::kPly;
  if (extension == ".obj") return Format::kObj;
  if (extension == ".spz" || is_bare_spz(file.bytes())) return Format::kSpz;
  if (extension == ".las" || extension == ".laz") return Format::kLas;
  if (extension == ".e57") return Format::kE57;
  if (extension == ".toml") return Format::kPackage;
  if (trimmed(text.substr(0, 4096)).starts_with("{")) return Format::kGltf;
  return Error(ErrorCode::kBadData,
               fmt::format("'{}' is no scene: give a folder with scene.toml, or a .glb, .gltf, .ply, "
                           ".obj, .las, .e57 or .spz file",
                           path.string()));
}

Result<Model> import_as(Format format, const std::filesystem::path& path, const ImportLimits& limits) {
  switch (format) {
    case Format::kPly:
      return import_ply(path, limits);
    case Format::kObj:
      return import_obj(path, limits);
    case Format::kLas:
      return import_las(path, limits);
    case Format::kE57:
      return import_e57(path, limits);
    case Format::kSpz:
      return import_spz(path, limits);
    case Format::kGltf:
      return import_gltf(path, limits);
    case Format::kPackage:
      break;
  }
  return Error(ErrorCode::kBadData, fmt::format("'{}' is not a geometry file that can be read", path.string()));
}

Result<Model> import_any(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const Format format, format_of(path));
  return import_as(format, path, limits);
}

StatedFrame stated_by(Format format) {
  if (format == Format::kLas || format == Format::kE57) return StatedFrame::kUpAndMetres;
  return format == Format::kGltf ? StatedFrame::kUp : StatedFrame::kNothing;
}

bool shines(const Eigen::Vector3f& light) { return light.maxCoeff() > 0.0f; }

bool has_light(const Scene& scene) {
  return !scene.model.lights.empty() || shines(scene.eye_lamp) || shines(scene.ambient) || shines(scene.sky.zenith) ||
         shines(scene.sky.horizon) || shines(scene.sky.ground);
}

/// Sets light and exposure where the package does not specify them.
void light(const ScenePackage& package, const FoundSettings& found, Scene* scene) {
  scene->tone = package.tone;
  const bool in_package =
      package.sky || package.environment || package.ambient || package.eye_lamp || !package.lamps.empty();
  if (!in_package && !has_light(*scene)) {
    add_light(found, scene);
    scene->exposure = package.exposure.value_or(1.0);
    return;
  }
  scene->exposure = package.exposure ? *package.exposure : find_exposure(found, *scene);
  if (!in_package) add_shadow_light(found, scene);
}

/// Returns the heading of a camera; 0 if it looks straight down.
double heading_of(const Viewpoint& view) { return std::atan2(view.direction.x(), -view.direction.z()); }

/// Makes the files' cameras the tour stops if the package has none, and the first camera the start if the package has
/// no start.
void add_viewpoints(ScenePackage* package, std::vector<Viewpoint> viewpoints, const Eigen::AlignedBox3d& bounds) {
  for (Viewpoint& view : viewpoints) view = level_viewpoint(view, bounds);
  if (package->stops.empty()) {
    for (const Viewpoint& view : viewpoints) package->stops.push_back({view.name, view.eye, heading_of(view)});
  }
  if (!package->start_eye && !viewpoints.empty()) {
    package->start_eye = viewpoints.front().eye;
    if (!package->start_heading_rad) package->start_heading_rad = heading_of(viewpoints.front());
  }
}

/// Returns a model with surfaces in place of splats, for the search for a start.
Model surfaces_of_splats(const Model& model) {
  Model surfaces;
  surfaces.materials.emplace_back();
  surfaces.meshes.push_back(shape_of(model.splats));
  surfaces.instances.push_back({0, Eigen::Affine3d::Identity()});
  return surfaces;
}

/// Returns a dark grey that shows the outline of a thing that has its own light.
Sky grey_surround() {
  const Eigen::Vector3f grey = Eigen::Vector3f::Constant(0.03f);
  return {grey, grey, grey};
}

/// Makes a scene of package and model; values that the package does not state are derived from the geometry.
Result<Scene> furnish(ScenePackage package, Model model, std::shared_ptr<const EnvironmentMap> environment,
                      const std::filesystem::path& path) {
  Scene scene;
  scene.model = std::move(model);
  scene.environment = std::move(environment);
  if (package.repair) {
    std::vector<std::string> done = repair_defects(&scene.model);
    std::move(done.begin(), done.end(), std::back_inserter(scene.model.notes));
  }
  scene.bounds = bounds_of(scene.model);
  if (scene.bounds.isEmpty()) {
    return Error(ErrorCode::kBadData,
                 fmt::format("'{}' holds neither triangles nor splats: there is nothing to show", path.string()));
  }
  add_viewpoints(&package, scene.model.viewpoints, scene.bounds);
  const bool is_splats = scene.model.instances.empty();
  const FoundSettings found =
      find_settings(is_splats ? surfaces_of_splats(scene.model) : scene.model, scene.bounds, package.start_eye);
  scene.info.title = std::move(package.title);
  scene.info.credits = package.credits.empty() ? scene.model.credits : std::move(package.credits);
  scene.info.start_eye = package.start_eye.value_or(found.eye);
  scene.info.start_heading_rad = package.start_heading_rad.value_or(found.heading_rad);
  scene.info.eye_height_m = package.eye_height_m.value_or(found.eye_height_m);
  scene.info.walking_scale = package.walking_scale.value_or(found.walking_scale);
  scene.info.walkable = package.walkable.empty() ? found.walkable : std::move(package.walkable);
  scene.info.walkable_holes = std::move(package.walkable_holes);
  scene.info.stops = std::move(package.stops);
  scene.info.lamp_groups = std::move(package.lamp_groups);
  scene.bounces = package.bounces;
  scene.sky = package.sky.value_or(Sky{});
  scene.ambient = package.ambient.value_or(Eigen::Vector3f::Zero());
  scene.eye_lamp = package.eye_lamp.value_or(Eigen::Vector3f::Zero());
  scene.model.lights.insert(scene.model.lights.end(), package.lamps.begin(), package.lamps.end());
  if (is_splats) {  // Splats contain their own light; a bright sky would shine between them.
    scene.tone = package.tone;
    scene.exposure = package.exposure.value_or(1.0);
    if (found.kind == SceneKind::kObject && !package.sky) scene.sky = grey_surround();
  } else {
    light(package, found, &scene);
  }
  free_lamps(&scene.model);
  make_plates_thin(&scene.model);
  return scene;
}

Result<Scene> load_package(const std::filesystem::path& path, const ImportLimits& limits,
                           const LoadProgress& progress) {
  TRY_ASSIGN(const std::string text, read_text_file(path, kPackageLimitBytes));
  TRY_ASSIGN(ScenePackage package, parse_scene_package(text, path.string(), path.parent_path()));
  Model model;
  double done = 0.0;
  for (const PackageGeometry& geometry : package.geometry) {
    TRY_ASSIGN(Model part, import_any(geometry.file, limits));
    std::vector<Eigen::Affine3d> T_scene_file;
    for (const Eigen::Affine3d& T : geometry.T_scene_part) {
      T_scene_file.push_back(T * T_part_file(geometry.unit_m, geometry.z_up));
    }
    add_part(std::move(part), geometry.unit_m, T_scene_file, &model);
    done += 1.0;
    if (progress) progress(0.9 * done / static_cast<double>(package.geometry.size()));
  }
  std::shared_ptr<const EnvironmentMap> environment;
  if (package.environment) {
    const PackageEnvironment& from = *package.environment;
    TRY_ASSIGN(RadianceImage pixels, read_environment(from.file, limits, &model.notes));
    environment =
        std::make_shared<const EnvironmentMap>(EnvironmentMap{std::move(pixels), from.rotation_rad, from.strength});
  }
  return furnish(std::move(package), std::move(model), std::move(environment), path);
}

Result<Scene> load_file(const std::filesystem::path& path, const ImportLimits& limits, const LoadProgress& progress) {
  TRY_ASSIGN(const Format format, format_of(path));
  TRY_ASSIGN(Model file, import_as(format, path, limits));
  if (progress) progress(0.8);
  const bool is_splats = file.instances.empty();
  FoundFrame frame = is_splats ? FoundFrame{} : find_frame(&file, stated_by(format));
  std::move(frame.notes.begin(), frame.notes.end(), std::back_inserter(file.notes));
  Model model;
  add_part(std::move(file), frame.unit_m, {frame.T_scene_file}, &model);
  ScenePackage package;
  package.title = path.stem().string();
  // Splats have the colours of photographs, which need no tone curve.
  if (is_splats) package.tone = ToneCurve::kLinear;
  return furnish(std::move(package), std::move(model), nullptr, path);
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& path, const ImportLimits& limits, const LoadProgress& progress) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  const std::filesystem::path file = is_folder ? path / "scene.toml" : path;
  if (is_folder && !std::filesystem::exists(file, error)) {
    return Error(ErrorCode::kNotFound, fmt::format("'{}' is no scene package: it has no scene.toml", path.string()));
  }
  const bool is_package = file.extension() == ".toml";
  try {
    Result<Scene> scene = is_package ? load_package(file, limits, progress) : load_file(file, limits, progress);
    if (scene && progress) progress(1.0);
    return scene;
  } catch (const std::bad_alloc&) {
    return Error(ErrorCode::kSystem, fmt::format("'{}': there is not enough memory; reduce the scene", path.string()));
  } catch (const std::exception& e) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' cannot be read: {}", path.string(), e.what()));
  }
}

std::uint64_t Scene::triangles_stored() const {
  std::uint64_t count = 0;
  for (const Mesh& mesh : model.meshes) count += mesh.triangles.size();
  return count;
}

std::uint64_t Scene::triangles_seen() const {
  std::uint64_t count = 0;
  for (const Instance& instance : model.instances) {
    count += model.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
  }
  return count;
}

std::size_t Scene::memory_bytes() const {
  const auto bytes_of = [](const auto& vector) { return vector.capacity() * sizeof(vector[0]); };
  std::size_t bytes = bytes_of(model.instances);
  for (const Mesh& mesh : model.meshes) {
    bytes += bytes_of(mesh.positions) + bytes_of(mesh.triangles) + bytes_of(mesh.normals) +
             bytes_of(mesh.texcoords[0]) + bytes_of(mesh.texcoords[1]) + bytes_of(mesh.tangents) +
             bytes_of(mesh.colours);
  }
  for (const Texture& texture : model.textures) bytes += texture.pixels.data().size();
  for (const SplatCloud& cloud : model.splats) bytes += cloud.memory_bytes();
  if (environment) bytes += environment->pixels.data().size_bytes();
  return bytes;
}

}  // namespace cyclorama::scene
