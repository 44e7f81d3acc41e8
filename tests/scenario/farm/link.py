# SPDX-License-Identifier: Apache-2.0
"""A TCP link that can be cut and broken: a proxy on [::1] between one process and the coordinator."""
import asyncio
import socket
import struct
import threading

from farm.processes import free_port


class Network:
    """The thread that moves the bytes of all links."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()

    def run(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self.loop).result(20)

    def stop(self):
        async def cancel():
            for task in asyncio.all_tasks() - {asyncio.current_task()}:
                task.cancel()
        self.run(cancel())
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join(20)
        self.loop.close()


class Link:
    """Listens on `port` and forwards to `target`. While it is cut nothing passes and no end is notified, as with a
    pulled cable: connections stay open, and new ones get no answer."""

    def __init__(self, network, target):
        self.network, self.target, self.port = network, target, free_port()
        self.writers, self.break_down, self.break_up = set(), False, False
        network.run(self._open())

    @property
    def address(self):
        return f"[::1]:{self.port}"

    def cut(self):
        self.network.run(self._set(False))

    def restore(self):
        self.network.run(self._set(True))

    def reset(self, downwards):
        """Ends the connections with RST within the next large message; `downwards`: from the coordinator."""
        self.network.run(self._break(downwards))

    async def _set(self, whole):
        self.whole.set() if whole else self.whole.clear()

    async def _break(self, downwards):
        self.break_down, self.break_up = downwards, not downwards

    async def _open(self):
        self.whole = asyncio.Event()
        self.whole.set()
        self.server = await asyncio.start_server(self._serve, "::1", self.port)

    async def _serve(self, reader, writer):
        self.writers.add(writer)
        try:
            await self.whole.wait()
            up_reader, up_writer = await asyncio.open_connection("::1", self.target)
        except OSError:  # The coordinator is down.
            self.writers.discard(writer)
            writer.close()
            return
        self.writers.add(up_writer)
        try:
            await asyncio.gather(self._pump(reader, up_writer, False), self._pump(up_reader, writer, True))
        except (OSError, asyncio.IncompleteReadError):
            pass
        finally:
            for end in (writer, up_writer):
                self.writers.discard(end)
                end.transport.abort()

    async def _pump(self, reader, writer, downwards):
        some = 2000  # Bytes: more than any message without pixels has.
        while data := await reader.read(1 << 16):
            await self.whole.wait()
            if len(data) > some and (self.break_down if downwards else self.break_up):
                self.break_down = self.break_up = False
                writer.write(data[:len(data) // 2])
                await writer.drain()
                for end in list(self.writers):
                    end.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER,
                                                            struct.pack("ii", 1, 0))
                    end.transport.abort()
                return
            writer.write(data)
            await writer.drain()
        raise ConnectionResetError  # When one side has ended, so does the other.
