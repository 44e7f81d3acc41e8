// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/program_id.h"

#include <elf.h>
#include <link.h>

#include <cstring>
#include <string_view>

namespace cyclorama::light_baking {
namespace {

constexpr std::size_t kAlignment = 4;

std::size_t aligned(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

/// Searches a segment of notes; source: elf(5).
std::span<const std::byte> build_id_in(std::span<const std::byte> notes) {
  constexpr std::string_view kOwner("GNU\0", 4);
  while (notes.size() >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) note{};
    std::memcpy(&note, notes.data(), sizeof(note));
    const std::size_t content = sizeof(note) + aligned(note.n_namesz);
    const std::size_t end = content + aligned(note.n_descsz);
    if (end > notes.size()) break;
    const bool is_build_id = note.n_type == NT_GNU_BUILD_ID && note.n_namesz == kOwner.size() &&
                             std::memcmp(notes.data() + sizeof(note), kOwner.data(), kOwner.size()) == 0;
    if (is_build_id) return notes.subspan(content, note.n_descsz);
    notes = notes.subspan(end);
  }
  return {};
}

}  // namespace

std::span<const std::byte> program_id() {
  static const std::span<const std::byte> kId = [] {
    std::span<const std::byte> found;
    // The first object is the program itself; the search ends there.
    ::dl_iterate_phdr(
        [](dl_phdr_info* object, std::size_t, void* result) {
          auto& id = *static_cast<std::span<const std::byte>*>(result);
          for (std::size_t i = 0; i < object->dlpi_phnum && id.empty(); ++i) {
            const ElfW(Phdr)& segment = object->dlpi_phdr[i];
            if (segment.p_type != PT_NOTE) continue;
            const ElfW(Addr) address = object->dlpi_addr + segment.p_vaddr;
            // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader gives addresses as integers.
            id = build_id_in({reinterpret_cast<const std::byte*>(address), segment.p_memsz});
          }
          return 1;
        },
        &found);
    return found;
  }();
  return kId;
}

}  // namespace cyclorama::light_baking
