#!/usr/bin/env python3
"""What strangers can do to a server: each attack once, what it costs, and whether it is refused as it should be.

  attacks.py [--only NAME ...]

Prints a line an attack. Exits with 1 when a server ends, an answer is another than it should be, or a cost is beyond its
bound. Costs are the processor's seconds, of the server and the processes that it decodes images in. Slow clients have
slow_clients.py, and full disks failing_calls.py.
"""

import argparse
import http.client
import json
import os
import shutil
import socket
import stat
import struct
import subprocess
import sys
import threading
import time
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import server_process
from server_process import Server

TICKS = os.sysconf("SC_CLK_TCK")
MEMORY_BACK_WITHIN_S = 10


def processes(pid):
    """A server and those that it started."""
    found = [pid]
    for task in Path(f"/proc/{pid}/task").iterdir():
        found += [int(child) for child in (task / "children").read_text().split()]
    return found


def processor_s(pid):
    """Of all of them, those that have ended too."""
    total = 0
    for process in processes(pid):
        fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
        total += sum(int(field) for field in fields[11:15])
    return total / TICKS


def memory_mib(pid):
    total = 0
    for process in processes(pid):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("RssAnon"):
                total += int(line.split()[1]) / 1024
    return total


def png(width, height, rows, depth=8, colour=0):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))
            + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def long_stream():
    """The rows of 64 x 64 pixels, and 2 GiB of zeros after the last."""
    packer = zlib.compressobj(9)
    out = [packer.compress(bytes(65) * 64)]
    zeros = bytes(1 << 24)
    out += [packer.compress(zeros) for _ in range(128)]
    return b"".join(out) + packer.flush()


class Attacks:
    def __init__(self):
        self.folder = server_process.new_folder("attacks")
        self.robots = server_process.rendered_images(self.folder / "world", 12)
        self.broken = []

    def server(self, *options, **more):
        server = Server(self.folder / "data", options, **more)
        if server.request("GET", "/v1/maps/honest")[0] == 404:
            self.expect("a map", server.request("POST", "/v1/maps", {"name": "honest"})[0], 201)
            for number, picture in enumerate(self.robots[0]):
                server.request("POST", f"/v1/maps/honest/images?name={number}", picture, "image/jpeg")
        return server

    def expect(self, what, found, *wanted):
        if found not in wanted:
            self.broken.append(what)
            print(f"  {what}: {found}, not {' or '.join(map(str, wanted))}", file=sys.stderr)

    def within(self, what, found, bound):
        if found > bound:
            self.broken.append(what)
            print(f"  {what}: {found:.2f}, more than {bound}", file=sys.stderr)

    def localize_s(self, server):
        begun = time.perf_counter()
        self.expect("localize", server.request("POST", "/v1/maps/honest/localize", self.robots[1][3], "image/jpeg")[0], 200)
        return time.perf_counter() - begun

    # Each returns what is printed.

    def long_png(self):
        server = self.server()
        image = png(64, 64, long_stream())
        before = min(self.localize_s(server) for _ in range(5))
        cost = processor_s(server.pid)
        with ThreadPoolExecutor(2) as pool:
            sent = [pool.submit(server.request, "POST", "/v1/maps/honest/localize", image, "image/png") for _ in range(2)]
            beside = self.localize_s(server)
            statuses = sorted(each.result()[0] for each in sent)
        cost = processor_s(server.pid) - cost
        for status in statuses:
            self.expect("a PNG that goes on behind its last row", status, 200, 422)
        self.within("its processor", cost, 1)
        server.kill()
        return (f"two PNGs of {len(image) / 1e6:.1f} MB whose stream goes on for 2 GiB: {statuses}, {cost:.2f} s of "
                f"processor, an honest localize {before * 1e3:.0f} -> {beside * 1e3:.0f} ms")

    def many_keys(self):
        server = self.server()
        body = json.dumps({f"{number:x}": 0 for number in range(100_000)}, separators=(",", ":"))
        cost = processor_s(server.pid)
        status = server.request("POST", "/v1/maps", body, "application/json")[0]
        cost = processor_s(server.pid) - cost
        self.expect("an object of 100,000 keys", status, 400)
        self.within("its processor", cost, 1)
        server.kill()
        return f"a JSON object of {len(body) / 1e3:.0f} kB with 100,000 keys: {status}, {cost:.2f} s of processor"

    def foreign_page(self):
        server = self.server()
        statuses = []
        for headers in ({"Origin": "http://evil.example", "Content-Type": "text/plain"}, {"Host": "evil.example"},
                        {"Host": "evil.example", "Origin": "http://evil.example"}):
            connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
            connection.request("POST", "/v1/maps", '{"name":"taken"}', headers)
            statuses.append(connection.getresponse().status)
            connection.close()
        for status, wanted in zip(statuses, (403, 421, 421)):
            self.expect("a page of another origin, or a name that is rebound", status, wanted)
        self.expect("the map", server.request("GET", "/v1/maps/taken")[0], 404)
        server.kill()
        return f"a foreign Origin, a foreign Host, both: {statuses}"

    def open_door(self):
        command = [self.server_binary(), "serve", "--data", str(self.folder / "open"), "--host", "0.0.0.0", "--port", "0"]
        refused = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        self.expect("--host 0.0.0.0 without keys", refused.returncode, 1)
        server = self.server()
        modes = {oct(stat.S_IMODE(file.stat().st_mode)) for file in (self.folder / "data").iterdir() if file.is_file()}
        self.expect("modes of files", modes, {"0o600"})
        self.localize_s(server)  # its decoders stand then
        decoders = [int(line.split()[1]) for pid in processes(server.pid)[1:]
                    for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("Seccomp:")]
        self.expect("seccomp of decoders", set(decoders), {2})
        server.kill()
        return f"--host 0.0.0.0 without keys ends with {refused.returncode}; files {modes}; {len(decoders)} decoders under seccomp"

    @staticmethod
    def server_binary():
        return str(server_process.binaries() / "mapweld-server")

    def large_bodies(self):
        server = self.server()
        for _ in range(3):
            self.localize_s(server)
        start = memory_mib(server.pid)
        peak = [start]
        done = threading.Event()

        def watch():
            while not done.wait(0.02):
                peak.append(memory_mib(server.pid))

        watcher = threading.Thread(target=watch)
        watcher.start()
        body = os.urandom(64 << 20)
        with ThreadPoolExecutor(8) as pool:
            bodies = sorted(pool.map(
                lambda _: server.request("POST", "/v1/maps/honest/localize", body, "image/jpeg")[0], range(8)))
        peak_bodies = max(peak) - start
        peak.clear()
        peak.append(memory_mib(server.pid))
        picture = png(4000, 4000, zlib.compress(bytes(4001) * 4000))
        with ThreadPoolExecutor(4) as pool:
            pictures = sorted(pool.map(
                lambda _: server.request("POST", "/v1/maps/honest/localize", picture, "image/png")[0], range(8)))
        done.set()
        watcher.join()
        time.sleep(MEMORY_BACK_WITHIN_S)
        end = memory_mib(server.pid)
        for status in bodies:
            self.expect("64 MiB of nothing", status, 415, 503)
        for status in pictures:
            self.expect("16 megapixels", status, 200, 503)
        self.within("memory afterwards (MiB)", end - start, 100)
        server.kill()
        return (f"8 bodies of 64 MiB: {bodies}, +{peak_bodies:.0f} MiB; 8 PNGs of 16 megapixels: {pictures}, "
                f"{start:.0f} -> {max(peak):.0f} MiB, {end:.0f} after {MEMORY_BACK_WITHIN_S} s")

    def few_descriptors(self):
        server = Server(self.folder / "data", [], binary=self.limited_binary(64))
        with ThreadPoolExecutor(50) as pool:
            def ask(_):
                try:
                    return server.request("GET", "/v1/maps/honest/graph")[0]
                except server_process.NoAnswer:
                    return 0
            statuses = list(pool.map(ask, range(50)))
        found = {status: statuses.count(status) for status in set(statuses)}
        for status in found:
            self.expect("a graph, with 64 descriptors", status, 200, 503, 0)
        self.expect("/healthz afterwards", server.request("GET", "/healthz")[0], 200)
        server.kill()
        return f"50 graphs at once with 64 descriptors: {found} (0: no connection)"

    def limited_binary(self, files):
        script = self.folder / "limited"
        script.write_text(f"#!/bin/sh\nulimit -n {files}\nexec {self.server_binary()} \"$@\"\n")
        script.chmod(0o755)
        return script

    def no_folder(self):
        server = self.server()
        shutil.move(self.folder / "data", self.folder / "gone")
        written = server.request("POST", "/v1/maps", {"name": "claimed"})[0]
        ready = server.request("GET", "/readyz")[0]
        self.expect("a write without a folder", written // 100, 5)
        self.expect("/readyz without a folder", ready, 503)
        server.kill()
        shutil.rmtree(self.folder / "data", ignore_errors=True)
        shutil.move(self.folder / "gone", self.folder / "data")
        server = self.server()
        second = subprocess.run([self.server_binary(), "serve", "--data", str(self.folder / "data"), "--port", "0"],
                                capture_output=True, timeout=60, check=False).returncode
        self.expect("a second server", second, 1)
        server.kill()
        return f"its folder moved away: a write {written}, /readyz {ready}; a second server on one folder ends with {second}"

    def small_chunks(self):
        server = self.server()
        mib = 1
        cost = processor_s(server.pid)
        with socket.create_connection(("127.0.0.1", server.port)) as client:
            client.sendall(b"POST /v1/maps/honest/localize HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: image/jpeg\r\n"
                           b"Transfer-Encoding: chunked\r\n\r\n")
            client.sendall(b"1\r\nx\r\n" * (mib << 20) + b"0\r\n\r\n")
            status = int(client.recv(65536).split()[1])
        cost = processor_s(server.pid) - cost
        self.expect("chunks of one byte", status, 415)
        self.within("their processor a MB", cost / mib, 0.5)
        server.kill()
        return f"{mib} MiB in chunks of one byte: {status}, {cost / mib:.2f} s of processor a MiB"


NAMES = ("long_png", "many_keys", "foreign_page", "open_door", "large_bodies", "few_descriptors", "no_folder",
         "small_chunks")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES)
    args = parser.parse_args()
    attacks = Attacks()
    try:
        for name in args.only:
            print(f"{name}: {getattr(attacks, name)()}", flush=True)
    finally:
        shutil.rmtree(attacks.folder, ignore_errors=True)
    if attacks.broken:
        print("broken: " + ", ".join(attacks.broken))
        sys.exit(1)


if __name__ == "__main__":
    main()
