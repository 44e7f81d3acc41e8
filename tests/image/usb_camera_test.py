#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the emulated USB camera's protocol without QEMU: packets survive any fragmentation; descriptors' lengths and
links are consistent; probe and commit; a picture survives its division into payloads. usb_camera_guest_test.py tests it
with Linux's uvcvideo."""
import random
import struct
import sys
import unittest

import usb_camera
import usb_redirection as redirection
from usb_camera import GET_CUR, GET_DEF, GET_DESCRIPTOR, GET_INFO, GET_LEN, GET_MAX, GET_MIN, SET_CUR, VideoDevice, payloads
from usb_redirection import BULK, CANCEL, CONTROL, HELLO, Redirected, Setup, Wire

SIZE = (16, 12)
TO_INTERFACE, FROM_INTERFACE, TO_ENDPOINT = 0x21, 0xa1, 0x02


class FakeClock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Computer:
    """QEMU's end of the connection."""

    def __init__(self, device, capabilities=0xff):
        self.here = Redirected(device)
        self.wire = Wire()
        self.wire.take(self.here.begin())
        self.known = self.wire.take(self.here.take(struct.pack("<III64sI", HELLO, 68, 0, b"computer", capabilities)))

    def ask(self, kind, number, body):
        return self.wire.take(self.here.take(self.wire.pack(kind, number, body)))

    def control(self, kind, request, value=0, index=0, length=0, data=b""):
        """Returns (status, answer)."""
        endpoint = kind & 0x80
        (answer,) = self.ask(CONTROL, 7, struct.pack("<BBBBHHH", endpoint, request, kind, 0, value, index,
                                                     len(data) or length) + data)
        status, length = answer.body[3], struct.unpack_from("<H", answer.body, 8)[0]
        assert answer.kind == CONTROL and answer.number == 7 and (not endpoint or length == len(answer.body) - 10)
        return status, answer.body[10:]

    def bulk(self):
        """Returns [(number, status, data)] of the data that are available now."""
        return [(packet.number, packet.body[1], packet.body[10:]) for packet in self.wire.take(self.here.give())]


def descriptors(data):
    """Splits descriptors by their lengths."""
    found = []
    while data:
        assert 2 <= data[0] <= len(data), data
        found.append(data[:data[0]])
        data = data[data[0]:]
    return found


class Packets(unittest.TestCase):
    def test_a_stream_cut_anywhere_is_the_same_packets(self):
        source = random.Random(4)
        there = Wire()
        stream = there.hello("there")
        there.take(Wire().hello("here"))
        wanted = [(kind, source.getrandbits(64), source.randbytes(source.randrange(60)))
                  for kind in (CONTROL, BULK, CANCEL) * 10]
        stream += b"".join(there.pack(*packet) for packet in wanted)
        for _ in range(20):
            here, rest, found = Wire(), stream, []
            while rest:
                cut = source.randrange(1, 40)
                found += here.take(rest[:cut])
                rest = rest[cut:]
            self.assertEqual([tuple(packet) for packet in found[1:]], wanted)

    def test_what_is_no_usbredir_is_refused(self):
        hello = Wire().hello("a")
        bad = {"no hello first": struct.pack("<III", CONTROL, 0, 0), "too long": struct.pack("<III", HELLO, 1 << 30, 0),
               "a second hello": hello + struct.pack("<IIQ", HELLO, 68, 0) + hello[12:],
               "no capabilities": struct.pack("<III64s", HELLO, 64, 0, b"old"),
               "no long numbers": struct.pack("<III64sI", HELLO, 68, 0, b"old", 0x50)}
        for name, data in bad.items():
            with self.subTest(name), self.assertRaises(redirection.ProtocolError):
                Wire().take(data)

    def test_it_is_plugged_in_after_its_endpoints_are_known(self):
        computer = Computer(VideoDevice(*SIZE))
        kinds = [packet.kind for packet in computer.known]
        self.assertEqual(kinds, [redirection.INTERFACES, redirection.ENDPOINTS, redirection.CONNECT])
        interfaces, ends, connect = (packet.body for packet in computer.known)
        self.assertEqual((len(interfaces), len(ends), len(connect)), (4 + 4 * 32, 3 * 32 + 64, 10))
        self.assertEqual((ends[17], ends[64 + 17], struct.unpack_from("<H", ends, 96 + 34)[0]), (2, 1, 512))
        self.assertEqual(connect, bytes([2, 0xef, 2, 1]) + struct.pack("<HHH", 0x1209, 1, 0x100))

    def test_configuration_and_alternatives(self):
        computer = Computer(VideoDevice(*SIZE))
        self.assertEqual(computer.ask(redirection.SET_CONFIGURATION, 5, b"\x01")[-1],
                         (redirection.CONFIGURATION_STATUS, 5, b"\x00\x01"))
        self.assertEqual(computer.ask(redirection.GET_CONFIGURATION, 6, b"")[-1].body, b"\x00\x01")
        self.assertEqual(computer.ask(redirection.SET_ALTERNATIVE, 7, b"\x01\x00")[-1].body, b"\x00\x01\x00")
        self.assertNotEqual(computer.ask(redirection.SET_ALTERNATIVE, 8, b"\x01\x01")[-1].body[0], 0)


class Descriptors(unittest.TestCase):
    def setUp(self):
        self.device = VideoDevice(640, 480, 10)
        self.parts = descriptors(self.device.configuration)

    def test_lengths(self):
        self.assertEqual((len(self.device.descriptor), self.device.descriptor[0]), (18, 18))
        self.assertEqual(struct.unpack_from("<H", self.parts[0], 2)[0], len(self.device.configuration))
        self.assertEqual([part[0] for part in self.parts], [9, 8, 9, 13, 18, 12, 9, 9, 14, 27, 30, 6, 7])
        control, stream = (next(i for i, part in enumerate(self.parts) if part[0] == size and part[1:3] == b"\x24\x01")
                           for size in (13, 14))
        self.assertEqual(struct.unpack_from("<H", self.parts[control], 5)[0],
                         sum(map(len, self.parts[control:control + 4])))
        self.assertEqual(struct.unpack_from("<H", self.parts[stream], 4)[0],
                         sum(map(len, self.parts[stream:stream + 4])))

    def test_links(self):
        camera, processing, output = self.parts[4:7]
        self.assertEqual((processing[4], output[7]), (camera[3], processing[3]))
        self.assertEqual((self.parts[8][6], self.parts[8][8]), (self.parts[-1][2], output[3]))

    def test_size_and_rate(self):
        frame = self.parts[10]
        self.assertEqual(struct.unpack_from("<HH", frame, 5), (640, 480))
        self.assertEqual(struct.unpack_from("<II", frame, 17), (640 * 480 * 2, 1_000_000))

    def test_as_asked_for(self):
        computer = Computer(self.device)
        self.assertEqual(computer.control(0x80, GET_DESCRIPTOR, 0x0100, 0, 64), (0, self.device.descriptor))
        self.assertEqual(computer.control(0x80, GET_DESCRIPTOR, 0x0200, 0, 9), (0, self.device.configuration[:9]))
        self.assertEqual(computer.control(0x80, GET_DESCRIPTOR, 0x0302, 0x0409, 255)[1][2:].decode("utf-16-le"),
                         "Test camera")
        for value in (0x0303, 0x0600, 0x0f00, 0x0201):
            self.assertEqual(computer.control(0x80, GET_DESCRIPTOR, value, 0, 64), (redirection.STALL, b""))


class Requests(unittest.TestCase):
    def setUp(self):
        self.device = VideoDevice(*SIZE)
        self.computer = Computer(self.device)

    def test_probe_and_commit(self):
        for selector in (1, 2):
            offers = {self.computer.control(FROM_INTERFACE, request, selector << 8, 1, 34)
                      for request in (GET_CUR, GET_DEF, GET_MIN, GET_MAX)}
            ((status, offer),) = offers
            self.assertEqual((status, len(offer)), (0, 34))
            self.assertEqual((offer[2], offer[3], *struct.unpack_from("<I", offer, 4)), (1, 1, 1_000_000))
            self.assertEqual(struct.unpack_from("<II", offer, 18), (16 * 12 * 2, usb_camera.PAYLOAD_BYTES))
            self.assertEqual(self.computer.control(FROM_INTERFACE, GET_LEN, selector << 8, 1, 2), (0, b"\x22\x00"))
            self.assertEqual(self.computer.control(FROM_INTERFACE, GET_INFO, selector << 8, 1, 1), (0, b"\x03"))
            self.assertEqual(self.computer.control(TO_INTERFACE, SET_CUR, selector << 8, 1, data=offer), (0, b""))
        self.assertEqual(self.computer.control(FROM_INTERFACE, GET_CUR, 3 << 8, 1, 34)[0], redirection.STALL)

    def test_exposure_and_gain(self):
        for unit, selector, size, value in ((1, 2, 1, 1), (1, 4, 4, 50), (2, 4, 2, 200)):
            at = {"value": selector << 8, "index": unit << 8}
            self.assertEqual(self.computer.control(FROM_INTERFACE, GET_LEN, **at, length=2)[1], struct.pack("<H", size))
            self.assertEqual(self.computer.control(TO_INTERFACE, SET_CUR, **at, data=value.to_bytes(size, "little")),
                             (0, b""))
            self.assertEqual(self.computer.control(FROM_INTERFACE, GET_CUR, **at, length=size),
                             (0, value.to_bytes(size, "little")))
        self.assertEqual(self.computer.control(FROM_INTERFACE, GET_CUR, 9 << 8, 1 << 8, 1)[0], redirection.STALL)
        self.assertIsNone(self.device.control(Setup(0xc0, 1, 0, 0, 4), b""))


class Pictures(unittest.TestCase):
    def setUp(self):
        self.clock = FakeClock()
        self.device = VideoDevice(*SIZE, clock=self.clock)
        self.grey = random.Random(8).randbytes(SIZE[0] * SIZE[1])
        self.device.show(self.grey)
        self.computer = Computer(self.device)

    def want(self, count, length=100):
        for number in range(count):
            self.assertEqual(self.computer.ask(BULK, 1 << 40 | number, struct.pack("<BBHIH", 0x81, 0, length, 0, 0)),
                             [])

    def test_cut_and_put_together(self):
        for size in (1, 97, 98, 99, 196, 1000):
            picture = random.Random(size).randbytes(size)
            cut = payloads(picture, 1, 100)
            self.assertEqual(b"".join(piece[2:] for piece in cut), picture)
            self.assertTrue(all(len(piece) <= 100 and piece[0] == 2 for piece in cut))
            self.assertEqual([piece[1] for piece in cut], [0x81] * (len(cut) - 1) + [0x83])

    def test_one_after_the_other_each_in_its_time(self):
        # 384 bytes make four payloads of 98.
        self.want(9)
        first = self.computer.bulk()
        self.assertEqual([number & 0xff for number, _, _ in first], [0, 1, 2, 3])
        self.assertEqual(b"".join(data[2:] for _, _, data in first)[::2], self.grey)
        self.assertEqual(self.computer.bulk(), [])
        self.device.show(bytes(len(self.grey)))
        self.clock.now += 0.1
        second = self.computer.bulk()
        self.assertEqual([number & 0xff for number, _, _ in second], [4, 5, 6, 7])
        self.assertEqual(b"".join(data[2:] for _, _, data in second), b"\x00\x80" * len(self.grey))
        self.assertEqual([data[1] & 1 for _, _, data in first + second], [1] * 4 + [0] * 4)
        self.assertEqual(self.device.sent, 2)

    def test_who_stops_and_begins_again_gets_a_whole_picture(self):
        self.want(2)
        self.assertEqual(len(self.computer.bulk()), 2)
        self.assertEqual(self.computer.control(TO_ENDPOINT, usb_camera.CLEAR_FEATURE, 0, 0x81), (0, b""))
        self.clock.now += 5
        self.want(4)
        again = self.computer.bulk()
        self.assertEqual(b"".join(data[2:] for _, _, data in again)[::2], self.grey)
        self.assertEqual(self.device.sent, 1)

    def test_a_cancelled_request_is_answered_once(self):
        self.computer.bulk()
        self.clock.now -= 1
        self.want(2)
        (answer,) = self.computer.ask(CANCEL, 1 << 40, b"")
        self.assertEqual((answer.kind, answer.number, answer.body[1]), (BULK, 1 << 40, redirection.CANCELLED))
        self.assertEqual(self.computer.ask(CANCEL, 1 << 40, b""), [])
        self.clock.now += 2
        self.assertEqual([number & 0xff for number, _, _ in self.computer.bulk()], [1])

    def test_another_size_is_refused(self):
        with self.assertRaises(ValueError):
            self.device.show(bytes(7))


if __name__ == "__main__":
    sys.exit(unittest.main())
