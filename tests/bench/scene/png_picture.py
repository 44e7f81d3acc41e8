# SPDX-License-Identifier: Apache-2.0
"""Reads and writes PNG files of 8-bit RGB without other libraries."""
import struct
import zlib


def paeth(left, above, corner):
    guess = left + above - corner
    nearest = min((abs(guess - left), 0), (abs(guess - above), 1), (abs(guess - corner), 2))[1]
    return (left, above, corner)[nearest]


def unfiltered(kind, row, before):
    """Undoes one of PNG's five filters in place. Source: PNG specification, section 9."""
    for i in range(len(row)):
        left = row[i - 3] if i >= 3 else 0
        corner = before[i - 3] if i >= 3 else 0
        row[i] = (row[i] + (0, left, before[i], (left + before[i]) // 2, paeth(left, before[i], corner))[kind]) & 255
    return row


def read(file):
    """Returns width, height and the rows as bytearrays."""
    data = file.read_bytes()
    width, height, depth, colour = struct.unpack(">IIBB", data[16:26])
    if (depth, colour) != (8, 2):
        raise ValueError(f"{file} is no 8-bit RGB picture")
    packed, at = b"", 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride = zlib.decompress(packed), 3 * width
    rows = [bytearray(stride)]
    for y in range(height):
        start = y * (stride + 1)
        rows.append(unfiltered(raw[start], bytearray(raw[start + 1:start + 1 + stride]), rows[-1]))
    return width, height, rows[1:]


def write(file, width, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packed = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))
