# SPDX-License-Identifier: Apache-2.0
"""An emulated USB camera for computers in QEMU: USB Video Class 1.1, YUYV of one size over a bulk endpoint (isochronous
endpoints need a bus with exact timing, which an emulated bus lacks). Exposure time and gain can be set but do not
affect the picture, which the caller provides.

    camera = UsbCamera(folder / "camera", 640, 480)
    machine = Appliance(disk, extra=camera.options())      # A USB port for this camera
    camera.show(grey_bytes); camera.plug(); camera.unplug()
"""
import select
import socket
import struct
import threading
import time

from usb_redirection import BULK_ENDPOINT, IN, ProtocolError, Redirected, endpoints

CONTROL_INTERFACE, STREAM_INTERFACE = 0, 1
CAMERA, PROCESSING, OUTPUT = 1, 2, 3  # The units of the camera: input terminal, processing, output terminal.
ENDPOINT, PACKET_BYTES = 0x81, 512
PAYLOAD_BYTES = 16384  # Payload with its header: the size of one request of Linux's uvcvideo (32 packets).
PER_SECOND = 10
TICKS = 10_000_000  # Units per second in which the class counts intervals.
YUY2 = bytes.fromhex("5955593200001000800000aa00389b71")
# USB: requests for any device.
GET_STATUS, CLEAR_FEATURE, SET_FEATURE, GET_DESCRIPTOR = 0, 1, 3, 6
# USB Video Class 1.1, A.8 and A.9.
SET_CUR, GET_CUR, GET_MIN, GET_MAX, GET_RES, GET_LEN, GET_INFO, GET_DEF = 0x01, 0x81, 0x82, 0x83, 0x84, 0x85, 0x86, 0x87
PROBE, COMMIT = 1, 2
EXPOSURE_MODE, EXPOSURE_TIME, GAIN = 2, 4, 4  # Selectors of the camera terminal (two) and of the processing unit.
END_OF_HEADER, END_OF_PICTURE, PICTURE = 0x80, 0x02, 0x01


def descriptor(kind, *fields):
    body = b"".join(bytes([field]) if isinstance(field, int) else field for field in fields)
    return bytes([len(body) + 2, kind]) + body


def w16(*numbers):
    return struct.pack(f"<{len(numbers)}H", *numbers)


def w32(*numbers):
    return struct.pack(f"<{len(numbers)}I", *numbers)


class Setting:
    """A control of the camera: (minimum, maximum, step, initial value) in so many bytes."""

    def __init__(self, size, minimum, maximum, step, first):
        self.size, self.now = size, first
        self._answers = {GET_MIN: minimum, GET_MAX: maximum, GET_RES: step, GET_DEF: first}

    def get(self, request):
        if request == GET_LEN:
            return w16(self.size)
        if request == GET_INFO:
            return b"\x03"  # It can be read and set.
        value = self.now if request == GET_CUR else self._answers.get(request)
        return None if value is None else value.to_bytes(self.size, "little")

    def set(self, data):
        self.now = int.from_bytes(data[:self.size], "little")


class VideoDevice:
    """The camera as a device for Redirected. Its owner calls show(); the computer calls the rest."""

    name = "cyclorama test camera"
    interfaces = [(CONTROL_INTERFACE, 0x0e, 1, 0), (STREAM_INTERFACE, 0x0e, 2, 0)]
    endpoints = endpoints(ENDPOINT, STREAM_INTERFACE, PACKET_BYTES)
    # 1209:0001 is for tests (pid.codes).
    descriptor = descriptor(1, w16(0x0200), 0xef, 2, 1, 64, w16(0x1209, 0x0001, 0x0100), 1, 2, 0, 1)
    _texts = {0: w16(0x0409), 1: "Cyclorama".encode("utf-16-le"), 2: "Test camera".encode("utf-16-le")}

    def __init__(self, width, height, per_second=PER_SECOND, clock=time.monotonic):
        self.width, self.height, self.interval = width, height, TICKS // per_second
        self.bytes = 2 * width * height
        self.sent = 0  # Number of whole pictures sent.
        self._clock = clock
        self._picture = b"\x10\x80" * (width * height)
        self._next_at = clock()
        self._identity = 0
        self._payloads = []
        # Manual or automatic exposure; units of 0.1 ms.
        self._settings = {(CAMERA, EXPOSURE_MODE): Setting(1, 1, 9, 9, 8),
                          (CAMERA, EXPOSURE_TIME): Setting(4, 1, 1000, 1, 100),
                          (PROCESSING, GAIN): Setting(2, 0, 255, 1, 64)}
        self.configuration = self._configuration()
        self._negotiated = {PROBE: self.offer(), COMMIT: self.offer()}

    def _configuration(self):
        rate = self.bytes * 8 * (TICKS // self.interval)
        units = (descriptor(0x24, 2, CAMERA, w16(0x0201), 0, 0, w16(0, 0, 0), 3, 0b1010, 0, 0) +
                 descriptor(0x24, 5, PROCESSING, CAMERA, w16(0), 2, w16(1 << 9), 0, 0)
                 + descriptor(0x24, 3, OUTPUT, w16(0x0101), 0, PROCESSING, 0))
        head = descriptor(0x24, 1, w16(0x0110, 13 + len(units)), w32(48_000_000), 1, STREAM_INTERFACE)
        formats = (descriptor(0x24, 4, 1, 1, YUY2, 16, 1, 0, 0, 0, 0) +
                   descriptor(0x24, 5, 1, 0, w16(self.width, self.height), w32(rate, rate, self.bytes, self.interval),
                              1, w32(self.interval)) +
                   descriptor(0x24, 0x0d, 1, 1, 4))
        stream = descriptor(0x24, 1, 1, w16(14 + len(formats)), ENDPOINT, 0, OUTPUT, 0, 0, 0, 1, 0)
        parts = (descriptor(0x0b, CONTROL_INTERFACE, 2, 0x0e, 3, 0, 2)
                 + descriptor(4, CONTROL_INTERFACE, 0, 0, 0x0e, 1, 0, 0) + head + units +
                 descriptor(4, STREAM_INTERFACE, 0, 1, 0x0e, 2, 0, 0) + stream + formats
                 + descriptor(5, ENDPOINT, BULK_ENDPOINT, w16(PACKET_BYTES), 0))
        return descriptor(2, w16(9 + len(parts)), 2, 1, 0, 0x80, 250) + parts

    def offer(self):
        """Returns probe and commit (4.3.1.1): the only format, size and rate."""
        return (w16(0) + bytes([1, 1]) + w32(self.interval) + w16(0, 0, 0, 0, 0)
                + w32(self.bytes, PAYLOAD_BYTES, 48_000_000) + bytes([3, 0, 0, 0]))

    def show(self, grey):
        """Sets the picture, from the next one on."""
        if len(grey) != self.width * self.height:
            raise ValueError(f"{len(grey)} bytes are no grey picture of {self.width}x{self.height}")
        picture = bytearray(b"\x80") * (2 * len(grey))
        picture[::2] = grey
        self._picture = bytes(picture)

    def control(self, setup, data):
        """Returns the answer, empty for a request that only sets, or None for a stall."""
        if setup.kind == IN and setup.request == GET_DESCRIPTOR:
            return self._descriptor(setup.value >> 8, setup.value & 0xff)
        if setup.kind & 0x7f <= 2 and setup.request == GET_STATUS:
            return w16(0)
        if setup.kind & 0x7f <= 2 and setup.request in (CLEAR_FEATURE, SET_FEATURE):
            # Clearing a halt restarts the endpoint; Linux ends a stream this way.
            self._payloads.clear()
            return b""
        if setup.kind & 0x7f != 0x21:
            return None
        unit, selector = setup.index >> 8, setup.value >> 8
        if setup.index & 0xff == STREAM_INTERFACE:
            return self._negotiate(setup.request, selector)
        setting = self._settings.get((unit, selector))
        if setting is None:
            return None
        if setup.request != SET_CUR:
            return setting.get(setup.request)
        setting.set(data)
        return b""

    def _descriptor(self, kind, index):
        if kind == 3:
            return descriptor(3, self._texts[index]) if index in self._texts else None
        return {1: self.descriptor, 2: self.configuration}.get(kind) if index == 0 else None

    def _negotiate(self, request, selector):
        if selector not in (PROBE, COMMIT):
            return None
        if request == SET_CUR:
            # The host may request anything; there is only one mode.
            if selector == COMMIT:
                self._payloads.clear()
            return b""
        return {GET_LEN: w16(len(self.offer())), GET_INFO: b"\x03"}.get(request, self.offer())

    def give(self, length):
        """Returns the next payload, or None before its time."""
        if not self._payloads:
            if (now := self._clock()) < self._next_at:
                return None
            # Missed pictures are skipped.
            self._next_at = max(self._next_at + self.interval / TICKS, now)
            self._identity ^= PICTURE
            self._payloads = payloads(self._picture, self._identity, min(length, PAYLOAD_BYTES))
            self._payloads.reverse()
        payload = self._payloads.pop()
        self.sent += not self._payloads
        return payload

    def due_in_s(self):
        return 0.0 if self._payloads else max(0.0, self._next_at - self._clock())


def payloads(picture, identity, most):
    """Returns a picture in payloads with a header each (2.4.3.3); the last one is marked."""
    room = most - 2
    pieces = [picture[at:at + room] for at in range(0, len(picture), room)]
    heads = [END_OF_HEADER | identity] * (len(pieces) - 1) + [END_OF_HEADER | END_OF_PICTURE | identity]
    return [bytes([2, head]) + piece for head, piece in zip(heads, pieces)]


class UsbCamera:
    """The camera with its cable."""

    def __init__(self, socket_path, width, height, per_second=PER_SECOND):
        self._path = str(socket_path)
        self._size = (width, height, per_second)
        self._grey = None
        self._cable = self._thread = None
        self.device = None  # Number of the newest connection.
        self.problem = ""

    def options(self, bus="usb.0"):
        """Returns QEMU's options for the port. The computer sees the camera after plug()."""
        return ["-chardev", f"socket,id=camera,path={self._path},server=on,wait=off", "-device",
                f"usb-redir,id=camera,chardev=camera,bus={bus}"]

    def show(self, grey):
        self._grey = grey
        if self.device:
            self.device.show(grey)

    def plug(self):
        self.device = VideoDevice(*self._size)
        if self._grey:
            self.device.show(self._grey)
        self._cable = socket.socket(socket.AF_UNIX)
        self._cable.connect(self._path)
        self._thread = threading.Thread(target=self._serve, args=(self._cable, self.device), daemon=True)
        self._thread.start()

    def unplug(self):
        if self._cable:
            self._cable.shutdown(socket.SHUT_RDWR)
            self._thread.join()
            self._cable.close()
            self._cable = None

    def sent(self):
        """Returns the number of whole pictures since it was plugged in."""
        return self.device.sent if self.device else 0

    def _serve(self, cable, device):
        redirected = Redirected(device)
        try:
            cable.sendall(redirected.begin())
            while True:
                seconds = min(0.2, device.due_in_s()) if redirected.waits() else 0.2
                if select.select([cable], [], [], seconds)[0]:
                    if not (came := cable.recv(65536)):
                        return
                    cable.sendall(redirected.take(came))
                if out := redirected.give():
                    cable.sendall(out)
        except (OSError, ProtocolError) as error:
            # A pulled cable ends like a broken one.
            self.problem = str(error)
