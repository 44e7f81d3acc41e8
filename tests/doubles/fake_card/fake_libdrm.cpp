// SPDX-License-Identifier: Apache-2.0
// Calls of libdrm, and of the files that it uses, implemented by the FakeMachine.
#include <drm_fourcc.h>
#include <fcntl.h>
#include <linux/sync_file.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>
#include <xf86drm.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <utility>

#include "tests/doubles/fake_card/fake_machine.h"

using cyclorama::FakeConnector;
using cyclorama::FakeMachine;

struct _drmModeAtomicReq {
  FakeMachine::State changes;
};

namespace {

FakeMachine& machine() { return FakeMachine::the(); }

/// Returns true if this call must fail, and then sets errno. libdrm returns null in this case.
bool fails(const char* call) {
  const int error = machine().meet(call);
  if (error != 0) errno = error;
  return error != 0;
}

FakeMachine::CardState* card_or_errno(int fd) {
  FakeMachine::CardState* const card = machine().card_of(fd);
  if (card == nullptr) errno = EBADF;
  return card;
}

/// C structures of libdrm, extended by the data to which they point.
struct Resources : drmModeRes {
  std::vector<std::uint32_t> crtc_ids, connector_ids;
};
struct ConnectorInfo : drmModeConnector {
  std::vector<drmModeModeInfo> listed;
};
struct PlaneResources : drmModePlaneRes {
  std::vector<std::uint32_t> ids;
};
struct PlaneInfo : drmModePlane {
  std::vector<std::uint32_t> listed;
};
struct ObjectProperties : drmModeObjectProperties {
  std::vector<std::uint32_t> ids;
  std::vector<std::uint64_t> values;
};
struct PropertyInfo : drmModePropertyRes {
  std::vector<std::uint64_t> range;
};
struct BlobInfo : drmModePropertyBlobRes {
  std::vector<std::uint8_t> bytes;
};
struct Device : drmDevice {
  std::array<std::string, DRM_NODE_MAX> paths;
  std::array<char*, DRM_NODE_MAX> pointers{};
};

template <typename Made, typename Base>
void free_as(Base* pointer) {
  delete static_cast<Made*>(pointer);
}

std::vector<std::string> names_of(const FakeMachine::CardState& card, std::uint32_t object) {
  if (object < FakeMachine::kFirstConnector) return {"ACTIVE", "MODE_ID"};
  if (object >= FakeMachine::kFirstPrimary) {
    std::vector<std::string> names{"type",  "FB_ID",  "CRTC_ID", "SRC_X",  "SRC_Y", "SRC_W",
                                   "SRC_H", "CRTC_X", "CRTC_Y",  "CRTC_W", "CRTC_H"};
    if (card.card.has_fences) names.push_back("IN_FENCE_FD");
    return names;
  }
  std::vector<std::string> names{"CRTC_ID", "EDID", "link-status"};
  if (card.card.connectors.at(object - FakeMachine::kFirstConnector).max_bpc != 0) names.push_back("max bpc");
  return names;
}

std::uint64_t value_of(const FakeMachine::CardState& card, std::uint32_t object, const std::string& name) {
  if (name == "type") return object >= FakeMachine::kFirstCursor ? DRM_PLANE_TYPE_CURSOR : DRM_PLANE_TYPE_PRIMARY;
  if (name == "EDID") {
    const FakeConnector& connector = card.card.connectors.at(object - FakeMachine::kFirstConnector);
    return connector.is_connected && !connector.edid.empty() ? object : 0;  // The blob has the connector's number.
  }
  const auto found = card.state.find({object, FakeMachine::property_id(name)});
  return found == card.state.end() ? 0 : found->second;
}

ConnectorInfo* connector_info(std::uint32_t id, const FakeConnector& connector, bool is_connected) {
  auto* const made = new ConnectorInfo;
  made->connector_id = id;
  made->connector_type = connector.type;
  made->connector_type_id = connector.number;
  made->connection = is_connected ? DRM_MODE_CONNECTED : DRM_MODE_DISCONNECTED;
  if (is_connected) made->listed = connector.modes;
  made->count_modes = static_cast<int>(made->listed.size());
  made->modes = made->listed.data();
  return made;
}

}  // namespace

// The linker demands these names (--wrap).
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {

int __real_open(const char* path, int flags, ...);
int __real_close(int fd);
int __real_ioctl(int fd, unsigned long request, ...);
int __real_poll(pollfd* entries, nfds_t count, int timeout);

int __wrap_open(const char* path, int flags, ...) {
  FakeMachine* const fake = FakeMachine::the_or_null();
  FakeMachine::CardState* const card = fake == nullptr ? nullptr : fake->card_at(path);
  if (card == nullptr) {
    va_list arguments;
    va_start(arguments, flags);
    const auto mode = (flags & O_CREAT) != 0 ? va_arg(arguments, unsigned) : 0U;
    va_end(arguments);
    return __real_open(path, flags, mode);
  }
  if (fails("open")) return -1;
  const int fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  fake->opened(fd, card);
  return fd;
}

int __wrap_close(int fd) {
  if (FakeMachine* const fake = FakeMachine::the_or_null()) {
    fake->closed(fd);
    fake->shared.erase(fd);
    fake->fences.erase(fd);
  }
  return __real_close(fd);
}

/// Lets simulated time pass until the next event of these cards, or until the timeout.
int __wrap_poll(pollfd* entries, nfds_t count, int timeout) {
  FakeMachine* const fake = FakeMachine::the_or_null();
  const auto is_card = [&](const pollfd& entry) { return fake->card_of(entry.fd) != nullptr; };
  if (fake == nullptr || std::none_of(entries, entries + count, is_card)) return __real_poll(entries, count, timeout);
  cyclorama::TimePoint until = fake->clock().now() + std::chrono::milliseconds(timeout);
  for (const pollfd* entry = entries; entry != entries + count; ++entry) {
    for (const FakeMachine::FlipEvent& event : fake->card_of(entry->fd)->events) until = std::min(until, event.due);
  }
  fake->clock().wait_until(until);
  int ready = 0;
  for (pollfd* entry = entries; entry != entries + count; ++entry) {
    const auto& events = fake->card_of(entry->fd)->events;
    const bool is_due = std::any_of(events.begin(), events.end(),
                                    [&](const FakeMachine::FlipEvent& e) { return e.due <= fake->clock().now(); });
    entry->revents = static_cast<short>(is_due ? POLLIN : 0);
    ready += is_due ? 1 : 0;
  }
  return ready;
}

int __wrap_ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  FakeMachine* const fake = FakeMachine::the_or_null();
  if (fake == nullptr || fake->fences.count(fd) == 0) return __real_ioctl(fd, request, argument);
  if (request != SYNC_IOC_FILE_INFO || fails("ioctl")) return -1;
  const auto& file = *static_cast<const sync_file_info*>(argument);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel's interface passes the address as a number.
  auto& fence = *reinterpret_cast<sync_fence_info*>(static_cast<std::uintptr_t>(file.sync_fence_info));
  const cyclorama::TimePoint at = fake->fences.at(fd);
  fence.status = at <= fake->clock().now() ? 1 : 0;
  fence.timestamp_ns = static_cast<std::uint64_t>(cyclorama::to_nanoseconds(at));
  return 0;
}

int __wrap_drmGetDevices2(std::uint32_t, drmDevicePtr devices[], int max) {
  if (const int error = machine().meet("drmGetDevices2"); error != 0) return -error;
  int count = 0;
  for (const std::string path : {"/dev/dri/card0", "/dev/dri/card1"}) {
    if (machine().card_at(path) == nullptr || count == max) continue;
    auto* const device = new Device;
    device->available_nodes = 1 << DRM_NODE_PRIMARY;
    device->paths[DRM_NODE_PRIMARY] = path;
    device->pointers[DRM_NODE_PRIMARY] = device->paths[DRM_NODE_PRIMARY].data();
    device->nodes = device->pointers.data();
    devices[count++] = device;
  }
  return count;
}
void __wrap_drmFreeDevices(drmDevicePtr devices[], int count) {
  for (int i = 0; i < count; ++i) free_as<Device>(devices[i]);
}

int __wrap_drmIsMaster(int fd) {
  FakeMachine::CardState* const card = machine().card_of(fd);
  return !fails("drmIsMaster") && card != nullptr && card->master_fd == fd ? 1 : 0;
}
int __wrap_drmSetMaster(int fd) {
  if (fails("drmSetMaster")) return -1;
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr) return -1;
  if (card->is_master_taken) {
    errno = EBUSY;
    return -1;
  }
  card->master_fd = fd;
  return 0;
}
int __wrap_drmSetClientCap(int, std::uint64_t, std::uint64_t) { return -machine().meet("drmSetClientCap"); }
int __wrap_drmGetCap(int, std::uint64_t, std::uint64_t* ret_value) {
  if (const int error = machine().meet("drmGetCap"); error != 0) return -error;
  *ret_value = 1;
  return 0;
}

drmModeResPtr __wrap_drmModeGetResources(int fd) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetResources")) return nullptr;
  auto* const made = new Resources;
  for (std::uint32_t i = 0; i < card->card.crtcs; ++i) made->crtc_ids.push_back(FakeMachine::kFirstCrtc + i);
  for (std::uint32_t i = 0; i < card->card.connectors.size(); ++i)
    made->connector_ids.push_back(FakeMachine::kFirstConnector + i);
  made->count_crtcs = static_cast<int>(made->crtc_ids.size());
  made->crtcs = made->crtc_ids.data();
  made->count_connectors = static_cast<int>(made->connector_ids.size());
  made->connectors = made->connector_ids.data();
  return made;
}
void __wrap_drmModeFreeResources(drmModeResPtr pointer) { free_as<Resources>(pointer); }

drmModeConnectorPtr __wrap_drmModeGetConnector(int fd, std::uint32_t id) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetConnector")) return nullptr;
  machine().lock_connectors();
  FakeConnector& connector = card->card.connectors.at(id - FakeMachine::kFirstConnector);
  machine().spend(connector.probe_time);
  connector.known_connected = connector.is_connected && connector.has_hot_plug;
  return connector_info(id, connector, *connector.known_connected);
}
drmModeConnectorPtr __wrap_drmModeGetConnectorCurrent(int fd, std::uint32_t id) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetConnectorCurrent")) return nullptr;
  machine().lock_connectors();
  const FakeConnector& connector = card->card.connectors.at(id - FakeMachine::kFirstConnector);
  return connector_info(id, connector, connector.known_connected.value_or(false));
}
void __wrap_drmModeFreeConnector(drmModeConnectorPtr pointer) { free_as<ConnectorInfo>(pointer); }
std::uint32_t __wrap_drmModeConnectorGetPossibleCrtcs(int fd, const drmModeConnector* connector) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeConnectorGetPossibleCrtcs")) return 0;
  return card->card.connectors.at(connector->connector_id - FakeMachine::kFirstConnector).possible_crtcs;
}

drmModePlaneResPtr __wrap_drmModeGetPlaneResources(int fd) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetPlaneResources")) return nullptr;
  auto* const made = new PlaneResources;
  for (std::uint32_t i = 0; i < card->card.crtcs; ++i) {
    made->ids.push_back(FakeMachine::kFirstCursor + i);  // The order is deliberately inconvenient.
    made->ids.push_back(FakeMachine::kFirstPrimary + i);
  }
  made->count_planes = static_cast<std::uint32_t>(made->ids.size());
  made->planes = made->ids.data();
  return made;
}
void __wrap_drmModeFreePlaneResources(drmModePlaneResPtr pointer) { free_as<PlaneResources>(pointer); }

drmModePlanePtr __wrap_drmModeGetPlane(int fd, std::uint32_t id) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetPlane")) return nullptr;
  const bool is_cursor = id >= FakeMachine::kFirstCursor;
  auto* const made = new PlaneInfo;
  made->plane_id = id;
  made->possible_crtcs = 1U << (id - (is_cursor ? FakeMachine::kFirstCursor : FakeMachine::kFirstPrimary));
  made->listed = {is_cursor ? DRM_FORMAT_ARGB8888 : DRM_FORMAT_XRGB8888};
  if (!is_cursor && card->card.can_be_deep) made->listed.push_back(DRM_FORMAT_XRGB2101010);
  made->count_formats = static_cast<std::uint32_t>(made->listed.size());
  made->formats = made->listed.data();
  return made;
}
void __wrap_drmModeFreePlane(drmModePlanePtr pointer) { free_as<PlaneInfo>(pointer); }

drmModeObjectPropertiesPtr __wrap_drmModeObjectGetProperties(int fd, std::uint32_t id, std::uint32_t) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeObjectGetProperties")) return nullptr;
  machine().lock_connectors();
  auto* const made = new ObjectProperties;
  for (const std::string& name : names_of(*card, id)) {
    made->ids.push_back(FakeMachine::property_id(name));
    made->values.push_back(value_of(*card, id, name));
  }
  made->count_props = static_cast<std::uint32_t>(made->ids.size());
  made->props = made->ids.data();
  made->prop_values = made->values.data();
  return made;
}
void __wrap_drmModeFreeObjectProperties(drmModeObjectPropertiesPtr pointer) { free_as<ObjectProperties>(pointer); }

drmModePropertyPtr __wrap_drmModeGetProperty(int, std::uint32_t id) {
  if (fails("drmModeGetProperty")) return nullptr;
  auto* const made = new PropertyInfo;
  made->prop_id = id;
  const std::string name = FakeMachine::property_name(id);
  std::strncpy(made->name, name.c_str(), sizeof made->name - 1);
  made->flags = DRM_MODE_PROP_RANGE;
  made->range = {0, name == "max bpc" ? 12U : UINT64_MAX};
  made->count_values = 2;
  made->values = made->range.data();
  return made;
}
void __wrap_drmModeFreeProperty(drmModePropertyPtr pointer) { free_as<PropertyInfo>(pointer); }

drmModePropertyBlobPtr __wrap_drmModeGetPropertyBlob(int fd, std::uint32_t id) {
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || fails("drmModeGetPropertyBlob")) return nullptr;
  auto* const made = new BlobInfo;
  made->bytes = card->card.connectors.at(id - FakeMachine::kFirstConnector).edid;
  made->id = id;
  made->length = static_cast<std::uint32_t>(made->bytes.size());
  made->data = made->bytes.data();
  return made;
}
void __wrap_drmModeFreePropertyBlob(drmModePropertyBlobPtr pointer) { free_as<BlobInfo>(pointer); }

int __wrap_drmModeCreatePropertyBlob(int fd, const void* data, std::size_t size, std::uint32_t* ret_id) {
  if (const int error = machine().meet("drmModeCreatePropertyBlob"); error != 0) return -error;
  FakeMachine::CardState* const card = machine().card_of(fd);
  if (card == nullptr) return -EBADF;
  const auto* const bytes = static_cast<const std::uint8_t*>(data);
  *ret_id = machine().next_id();
  card->blobs[*ret_id] = {bytes, bytes + size};
  return 0;
}
int __wrap_drmModeDestroyPropertyBlob(int fd, std::uint32_t) {
  // The kernel keeps a mode's blob as long as a CRTC uses it; this double keeps all blobs.
  return machine().card_of(fd) == nullptr ? -EBADF : -machine().meet("drmModeDestroyPropertyBlob");
}

drmModeAtomicReqPtr __wrap_drmModeAtomicAlloc() {
  return fails("drmModeAtomicAlloc") ? nullptr : new _drmModeAtomicReq;
}
void __wrap_drmModeAtomicFree(drmModeAtomicReqPtr pointer) { delete pointer; }
int __wrap_drmModeAtomicAddProperty(drmModeAtomicReqPtr request, std::uint32_t object, std::uint32_t property,
                                    std::uint64_t value) {
  if (const int error = machine().meet("drmModeAtomicAddProperty"); error != 0) return -error;
  request->changes[{object, property}] = value;
  return static_cast<int>(request->changes.size());
}
int __wrap_drmModeAtomicCommit(int fd, const drmModeAtomicReqPtr request, std::uint32_t flags, void* cookie) {
  const char* const call = (flags & DRM_MODE_ATOMIC_TEST_ONLY) != 0       ? "drmModeAtomicCommit (test)"
                           : (flags & DRM_MODE_ATOMIC_ALLOW_MODESET) != 0 ? "drmModeAtomicCommit (modeset)"
                                                                          : "drmModeAtomicCommit (flip)";
  if (const int error = machine().meet(call); error != 0) return -error;
  if ((flags & DRM_MODE_ATOMIC_ALLOW_MODESET) != 0) machine().lock_connectors();
  FakeMachine::CardState* const card = machine().card_of(fd);
  return card == nullptr ? -EBADF : -machine().commit(card, request->changes, flags, cookie, fd);
}

int __wrap_drmModeAddFB2(int fd, std::uint32_t width, std::uint32_t height, std::uint32_t format,
                         const std::uint32_t handles[4], const std::uint32_t strides[4], const std::uint32_t[4],
                         std::uint32_t* ret_id, std::uint32_t) {
  if (const int error = machine().meet("drmModeAddFB2"); error != 0) return -error;
  FakeMachine::CardState* const card = machine().card_of(fd);
  if (card == nullptr) return -EBADF;
  const gbm_bo* buffer = nullptr;
  if (const auto imported = card->imported.find(handles[0]); imported != card->imported.end()) {
    buffer = imported->second;
  } else if (card->card.path == "/dev/dri/card0") {  // Only this card renders.
    for (const gbm_bo* const made : machine().buffers) {
      if (made->handle == handles[0]) buffer = made;
    }
  }
  if (buffer == nullptr) return -ENOENT;
  if (strides[0] < 4 * width || buffer->width < width || buffer->height < height) return -EINVAL;
  *ret_id = machine().next_id();
  card->framebuffers[*ret_id] = {buffer, width, height, format};
  return 0;
}
int __wrap_drmModeRmFB(int fd, std::uint32_t id) {
  if (const int error = machine().meet("drmModeRmFB"); error != 0) return -error;
  FakeMachine::CardState* const card = machine().card_of(fd);
  if (card == nullptr || card->framebuffers.erase(id) == 0) return -ENOENT;
  // A CRTC that scans out the framebuffer is turned off.
  for (auto& [key, value] : card->state) {
    if (FakeMachine::property_name(key.second) != "FB_ID" || value != id) continue;
    const std::uint32_t crtc = FakeMachine::kFirstCrtc + (key.first - FakeMachine::kFirstPrimary);
    card->state[{crtc, FakeMachine::property_id("ACTIVE")}] = 0;
    card->state[{key.first, FakeMachine::property_id("CRTC_ID")}] = 0;
    value = 0;
  }
  return 0;
}

int __wrap_drmPrimeFDToHandle(int fd, int shared, std::uint32_t* ret_handle) {
  if (fails("drmPrimeFDToHandle")) return -1;
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr || machine().shared.count(shared) == 0) return -1;
  *ret_handle = machine().next_id();
  card->imported[*ret_handle] = machine().shared.at(shared);
  return 0;
}
int __wrap_drmCloseBufferHandle(int fd, std::uint32_t handle) {
  if (fails("drmCloseBufferHandle")) return -1;
  FakeMachine::CardState* const card = card_or_errno(fd);
  return card != nullptr && card->imported.erase(handle) == 1 ? 0 : -1;
}

int __wrap_drmHandleEvent(int fd, drmEventContextPtr handlers) {
  if (fails("drmHandleEvent")) return -1;
  FakeMachine::CardState* const card = card_or_errno(fd);
  if (card == nullptr) return -1;
  const cyclorama::TimePoint now = machine().clock().now();
  for (const FakeMachine::FlipEvent& event : std::exchange(card->events, {})) {
    if (event.due > now) {
      card->events.push_back(event);
      continue;
    }
    const auto us = cyclorama::to_nanoseconds(event.due) / 1000;
    handlers->page_flip_handler2(fd, card->card.has_raster ? ++machine().sequence : 0,
                                 static_cast<unsigned>(us / 1'000'000), static_cast<unsigned>(us % 1'000'000),
                                 event.crtc, event.cookie);
  }
  return 0;
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
