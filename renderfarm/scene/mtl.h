// SPDX-License-Identifier: Apache-2.0
/// MTL materials, converted to glTF's metallic-roughness model as closely as possible.
///
///   Kd, map_Kd   base colour
///   Ke, map_Ke   emission
///   Ks, Ns       roughness: GGX width with the same highlight as Blinn-Phong's exponent, alpha = sqrt(2 / (Ns + 2))
///                (B. Karis, 2013, "Specular BRDF Reference")
///   d, Tr        opacity
///   Pr, Pm       roughness and metallic, unchanged
///   Pc, Pcr      clearcoat and its roughness
///   norm         normal map
///   map_d        alpha mask, if it is the same picture as map_Kd
///
/// Other statements are ignored with a note.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Materials of one OBJ file and their pictures. Thread-bound.
class MtlLibrary {
 public:
  /// Files are searched in `folder` and below. Of a name that leads outside, such as an absolute path of another
  /// machine, only the last part is used.
  MtlLibrary(std::filesystem::path folder, const ImportLimits& limits);

  /// Reads the files in `names`, the text after "mtllib". A file that is missing or invalid is noted, and the model is
  /// shown without it.
  void read(std::string_view names);
  /// Returns the index in the model of the material called `name`; if there is none, that of the plain material, with a
  /// note.
  int use(std::string_view name);

  /// Decodes the pictures of the used materials, and moves materials, textures and notes into the model.
  void finish(Model* model) &&;

 private:
  struct Entry {
    Material material;
    std::string base_colour_file;
    std::string emissive_file;
    std::string normal_file;
    std::string cut_out_file;
  };
  /// Reads one file; returns false if there is no such file.
  bool read_one(std::string_view name);
  void parse(std::string_view text, const std::string& name);
  void read_statement(std::string_view keyword, std::string_view rest, Entry* entry);
  int texture(const std::string& file, Model* model);
  void note_once(const std::string& note);

  std::filesystem::path folder_;
  ImportLimits limits_;
  std::map<std::string, Entry, std::less<>> known_;
  std::map<std::string, int, std::less<>> used_;  ///< Maps names to indices in `in_use_`.
  std::vector<Entry> in_use_;
  std::map<std::string, int> textures_;  ///< Texture index by file name; -1 if the file cannot be read.
  std::size_t texture_bytes_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace cyclorama::scene
