// SPDX-License-Identifier: Apache-2.0
/// MTL materials, as near to glTF's metallic-roughness model as they come.
///
///   Kd, map_Kd   base colour
///   Ke, map_Ke   emission
///   Ks, Ns       roughness: Blinn-Phong's exponent as the GGX width that shines alike, alpha = sqrt(2 / (Ns + 2))
///                (B. Karis, 2013, "Specular BRDF Reference")
///   d, Tr        opacity
///   Pr, Pm       roughness and metallic as such
///   Pc, Pcr      clearcoat and its roughness
///   norm         normal map
///   map_d        cut-out, when it is the picture of map_Kd
///
/// What else a file asks for is noted.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Materials of one OBJ file, and the pictures they use. Thread-bound.
class MtlLibrary {
 public:
  /// Files are looked for in `folder` and below, never elsewhere: a name that leads out of it (other people's absolute
  /// paths) is looked for by its last part.
  MtlLibrary(std::filesystem::path folder, const ImportLimits& limits);

  /// `names` is what follows "mtllib". A file that is absent or wrong is noted; the model is shown without it.
  void read(std::string_view names);
  /// The material called `name`, or the plain one after a note. An index into the model's materials.
  int use(std::string_view name);

  /// Decodes the pictures of the materials in use and moves all into the model.
  void finish(Model* model) &&;

 private:
  struct Entry {
    Material material;
    std::string base_colour_file;
    std::string emissive_file;
    std::string normal_file;
    std::string cut_out_file;
  };
  /// False when there is no such file.
  bool read_one(std::string_view name);
  void parse(std::string_view text, const std::string& name);
  void read_statement(std::string_view keyword, std::string_view rest, Entry* entry);
  int texture(const std::string& file, Model* model);
  void note_once(const std::string& note);

  std::filesystem::path folder_;
  ImportLimits limits_;
  std::map<std::string, Entry, std::less<>> known_;
  std::map<std::string, int, std::less<>> used_;  ///< Name to place in in_use_.
  std::vector<Entry> in_use_;
  std::map<std::string, int> textures_;  ///< By file name; -1 is one that cannot be read.
  std::size_t texture_bytes_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace cyclorama
