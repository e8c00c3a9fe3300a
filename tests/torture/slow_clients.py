#!/usr/bin/env python3
"""Holds a server's connections open the way slow, idle and hostile clients do, and measures what others notice.

  slow_clients.py --port 8080 --pid PID [--map lab-a --image query.jpg] [--seconds 20]

Three times, quiet, under attack, and when the attackers have gone: how long /healthz and localize take, and the memory
of the process. The bars: /healthz p99 under 250 ms, localize p99 under three times that of the quiet server (the whole
machine is shared, so each is also given against a second quiet measurement), memory within 200 MiB of its start and back
within 20 MiB. Exits with 1 when one is missed.
"""

import argparse
import http.client
import json
import multiprocessing
import os
import resource
import select
import socket
import statistics
import sys
import time

HEAD = "Host: 127.0.0.1\r\n"


def attacker(args):
    """Holds the connections; opens each anew when the server closes it."""
    head = ("GET /healthz HTTP/1.1\r\n" + HEAD + "X: ").encode()
    body = ("POST /v1/maps HTTP/1.1\r\n" + HEAD + "Content-Length: 100000\r\n\r\n").encode()
    stream = ("GET /v1/events HTTP/1.1\r\n" + HEAD + "\r\n").encode()
    missing = [(b"", b"")] * args.idle + [(stream, b"")] * args.streams
    missing += [(head, b"x")] * args.heads + [(body, b"xxx")] * args.bodies
    poll = select.epoll()
    held = {}
    drip_at = time.monotonic() + 1
    while True:
        for opening, drip in missing:
            client = socket.socket()
            try:
                client.connect(("127.0.0.1", args.port))
                client.setblocking(False)
                client.send(opening)
            except OSError:
                pass  # noticed below
            held[client.fileno()] = (client, opening, drip)
            poll.register(client.fileno(), select.EPOLLIN)
        missing = []
        for descriptor, _ in poll.poll(0.05):
            client, opening, drip = held[descriptor]
            try:
                if client.recv(65536):
                    continue
            except BlockingIOError:
                continue
            except OSError:
                pass
            poll.unregister(descriptor)
            del held[descriptor]
            client.close()
            missing.append((opening, drip))
        if time.monotonic() >= drip_at:
            drip_at = time.monotonic() + 1
            for client, _, drip in held.values():
                try:
                    client.send(drip)
                except OSError:
                    pass  # noticed above


def request(port, method, path, body=None):
    """Seconds that one request takes on a connection of its own."""
    started = time.perf_counter()
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request(method, path, body=body, headers={"Content-Type": "image/jpeg"} if body else {})
    reply = connection.getresponse()
    reply.read()
    connection.close()
    if reply.status >= 400:
        raise RuntimeError(f"{method} {path}: {reply.status}")
    return time.perf_counter() - started


def p99(times_s):
    return sorted(times_s)[max(0, int(len(times_s) * 0.99) - 1)]


def measure(args, image, seconds):
    times = {"healthz": [], "localize": []}
    failed = 0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            for _ in range(5):
                times["healthz"].append(request(args.port, "GET", "/healthz"))
            if image:
                times["localize"].append(request(args.port, "POST", f"/v1/maps/{args.map}/localize", image))
        except (OSError, RuntimeError, http.client.HTTPException) as error:
            failed += 1
            print("failed:", error, file=sys.stderr)
        time.sleep(0.01)
    result = {"failed": failed}
    for name, values in times.items():
        if values:
            result[name] = {"n": len(values), "median_ms": round(statistics.median(values) * 1e3, 2),
                            "p99_ms": round(p99(values) * 1e3, 2)}
    return result


def rss_mib(pid):
    with open(f"/proc/{pid}/status") as status:
        for line in status:
            if line.startswith("VmRSS"):
                return int(line.split()[1]) / 1024
    return 0.0


def open_files(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--pid", type=int, required=True)
    parser.add_argument("--map")
    parser.add_argument("--image")
    parser.add_argument("--seconds", type=float, default=20)
    for name, number in (("heads", 500), ("bodies", 500), ("streams", 64), ("idle", 2000)):
        parser.add_argument("--" + name, type=int, default=number)
    args = parser.parse_args()
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    image = open(args.image, "rb").read() if args.image else None

    measure(args, image, 3)  # the first requests load maps
    quiet = measure(args, image, args.seconds)
    start_mib = rss_mib(args.pid)
    process = multiprocessing.Process(target=attacker, args=(args,), daemon=True)
    process.start()
    time.sleep(5)  # until they stand
    files = open_files(args.pid)
    attacked = measure(args, image, args.seconds)
    attacked_mib = rss_mib(args.pid)
    process.terminate()
    process.join()
    time.sleep(3)
    after = measure(args, image, args.seconds / 2)
    after_mib = rss_mib(args.pid)

    misses = []
    if attacked["failed"]:
        misses.append(f'{attacked["failed"]} requests failed')
    if attacked["healthz"]["p99_ms"] >= 250:
        misses.append("healthz p99")
    if image and attacked["localize"]["p99_ms"] >= 3 * quiet["localize"]["p99_ms"]:
        misses.append("localize p99")
    if attacked_mib - start_mib > 200:
        misses.append("memory under attack")
    if after_mib - start_mib > 20:
        misses.append("memory afterwards")
    print(json.dumps({"quiet": quiet, "attacked": attacked, "afterwards": after,
                      "open_files_attacked": files,
                      "rss_mib": {"start": round(start_mib, 1), "attacked": round(attacked_mib, 1),
                                  "afterwards": round(after_mib, 1)},
                      "misses": misses}, indent=1))
    sys.exit(1 if misses else 0)


if __name__ == "__main__":
    main()
