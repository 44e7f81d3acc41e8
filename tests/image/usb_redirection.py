# SPDX-License-Identifier: Apache-2.0
"""The other end of QEMU's `-device usb-redir`: a USB device as a Python program. In the usbredir protocol 0.7,
little-endian packets have a header (kind, length, number) and a body; hello comes first, then the device's endpoints,
then its connection.

    QEMU                     here
    hello            ◀─▶     hello
                     ◀──     interfaces, endpoints, connect
    set configuration──▶     interfaces, endpoints, configuration's status
    control          ──▶     control               the device's answer; its status may be a stall
    bulk (so many)   ──▶     bulk (at most so many)   later, when the device has data
    cancel           ──▶     bulk, cancelled

QEMU's xHCI requires three capabilities: 64-bit numbers, endpoints' packet sizes, long bulk packets. Bulk streams are
not supported.
"""
import collections
import struct

HELLO, CONNECT, _, RESET, INTERFACES, ENDPOINTS, SET_CONFIGURATION, GET_CONFIGURATION, CONFIGURATION_STATUS, SET_ALTERNATIVE, GET_ALTERNATIVE, \
    ALTERNATIVE_STATUS = range(12)
CANCEL, CONTROL, BULK = 21, 100, 101
SUCCESS, CANCELLED, INVALID, STALL = 0, 1, 2, 4
HIGH_SPEED = 2
NO_ENDPOINT, CONTROL_ENDPOINT, BULK_ENDPOINT = 255, 0, 2
CONNECT_VERSION, PACKET_SIZE, LONG_NUMBERS, LONG_BULK = 1, 4, 5, 6
OURS = 1 << CONNECT_VERSION | 1 << PACKET_SIZE | 1 << LONG_NUMBERS | 1 << LONG_BULK
MAX_BODY = 1 << 20  # Maximum size of a body; QEMU sends far smaller ones.
IN = 0x80

_HELLO = struct.Struct("<64sI")
_CONTROL = struct.Struct("<BBBBHHH")  # endpoint, request, kind of request, status, value, index, length
_BULK = struct.Struct("<BBHIH")  # endpoint, status, length, stream, length's high half

Packet = collections.namedtuple("Packet", "kind number body")
Setup = collections.namedtuple("Setup", "kind request value index length")


class ProtocolError(Exception):
    """The data are not usbredir, or the peer lacks a capability."""


class Wire:
    """Encodes and decodes packets. Numbers have 32 bits until both sides have announced 64."""

    def __init__(self):
        self._rest = b""
        self._is_long = False
        self.peer = None  # The peer's capabilities, None before its hello.

    def pack(self, kind, number=0, body=b""):
        return struct.pack("<IIQ" if self._is_long else "<III", kind, len(body), number) + body

    def hello(self, name):
        return self.pack(HELLO, 0, _HELLO.pack(name.encode(), OURS))

    def take(self, data):
        """Yields every complete packet."""
        self._rest += data
        packets = []
        while len(self._rest) >= (size := 16 if self._is_long else 12):
            kind, length, number = struct.unpack_from("<IIQ" if self._is_long else "<III", self._rest)
            if length > MAX_BODY or (self.peer is None) != (kind == HELLO):
                raise ProtocolError(f"a packet of kind {kind} with {length} bytes")
            if len(self._rest) < size + length:
                break
            body, self._rest = self._rest[size:size + length], self._rest[size + length:]
            if kind == HELLO:
                self.peer = struct.unpack_from("<I", body, 64)[0] if length >= 68 else 0
                if missing := [bit for bit in (PACKET_SIZE, LONG_NUMBERS, LONG_BULK) if not self.peer >> bit & 1]:
                    raise ProtocolError(f"the peer lacks the capabilities {missing}")
                self._is_long = True
            packets.append(Packet(kind, number, body))
        return packets


def interfaces(numbered):
    """Returns the packet for [(number, class, subclass, protocol)]."""
    columns = [bytes(column) + bytes(32 - len(numbered)) for column in zip(*numbered)]
    return struct.pack("<I", len(numbered)) + b"".join(columns)


def endpoints(bulk_in, interface, packet_bytes):
    """Returns the packet for a control endpoint and bulk endpoints from the device (0x81...). Slots 0 to 15 lead to the
    device, 16 to 31 from it."""
    kinds, sizes, of = [NO_ENDPOINT] * 32, [0] * 32, [0] * 32
    kinds[0] = kinds[16] = CONTROL_ENDPOINT
    sizes[0] = sizes[16] = 64
    at = 16 + (bulk_in & 0x0f)
    kinds[at], sizes[at], of[at] = BULK_ENDPOINT, packet_bytes, interface
    return bytes(kinds) + bytes(32) + bytes(of) + struct.pack("<32H", *sizes)


class Redirected:
    """The device's side of the protocol without a socket: bytes in, bytes out.

    The device has `name`, `descriptor` (the device descriptor), `interfaces`, `endpoints` as made above,
    control(setup, data) -> bytes, or None for a stall, and give(length) -> bytes, or None if there are none yet.
    """

    def __init__(self, device):
        self.device = device
        self.wire = Wire()
        self._configuration = 0
        self._wanted = collections.deque()  # Bulk requests (number, endpoint, bytes), the oldest first.

    def begin(self):
        return self.wire.hello(self.device.name)

    def take(self, data):
        """Returns the bytes to send in response."""
        return b"".join(self._answer(packet) for packet in self.wire.take(data))

    def give(self):
        """Returns the available bulk data for waiting requests."""
        out = b""
        while self._wanted:
            number, endpoint, length = self._wanted[0]
            data = self.device.give(length)
            if data is None:
                break
            self._wanted.popleft()
            out += self._bulk(number, endpoint, SUCCESS, data)
        return out

    def waits(self):
        return bool(self._wanted)

    def _what_it_is(self):
        return self.wire.pack(INTERFACES, 0,
                              interfaces(self.device.interfaces)) + self.wire.pack(ENDPOINTS, 0, self.device.endpoints)

    def _bulk(self, number, endpoint, status, data=b""):
        return self.wire.pack(BULK, number, _BULK.pack(endpoint, status, len(data) & 0xffff, 0, len(data) >> 16) + data)

    def _answer(self, packet):
        kind, number, body = packet
        if kind == HELLO:
            # USB 2.0, table 9-8: class, subclass, protocol at offset 4, then vendor, product, version at 8.
            return self._what_it_is() + self.wire.pack(CONNECT, 0, bytes([HIGH_SPEED]) + self.device.descriptor[4:7]
                                                       + self.device.descriptor[8:14])
        if kind == SET_CONFIGURATION:
            self._configuration = body[0]
            return self._what_it_is() + self.wire.pack(CONFIGURATION_STATUS, number,
                                                       bytes([SUCCESS, self._configuration]))
        if kind == GET_CONFIGURATION:
            return self.wire.pack(CONFIGURATION_STATUS, number, bytes([SUCCESS, self._configuration]))
        if kind in (SET_ALTERNATIVE, GET_ALTERNATIVE):
            wanted = body[1] if kind == SET_ALTERNATIVE else 0  # There is only one configuration.
            return self.wire.pack(ALTERNATIVE_STATUS, number, bytes([STALL if wanted else SUCCESS, body[0], 0]))
        if kind == CONTROL:
            return self._control(number, body)
        if kind == BULK:
            endpoint, _, low, _, high = _BULK.unpack_from(body)
            if not endpoint & IN:
                return self._bulk(number, endpoint, INVALID)
            self._wanted.append((number, endpoint, high << 16 | low))
            return b""
        if kind == CANCEL:
            given_up = [wanted for wanted in self._wanted if wanted[0] == number]
            self._wanted = collections.deque(wanted for wanted in self._wanted if wanted[0] != number)
            return b"".join(self._bulk(number, endpoint, CANCELLED) for _, endpoint, _ in given_up)
        return b""  # A reset; QEMU cancels requests by their numbers. Other packets need no answer.

    def _control(self, number, body):
        endpoint, request, request_kind, _, value, index, length = _CONTROL.unpack_from(body)
        data = self.device.control(Setup(request_kind, request, value, index, length), body[_CONTROL.size:])
        status = STALL if data is None else SUCCESS
        data = (data or b"")[:length]
        done = len(data) if request_kind & IN else length if status == SUCCESS else 0
        return self.wire.pack(CONTROL, number,
                              _CONTROL.pack(endpoint, request, request_kind, status, value, index, done) + data)
