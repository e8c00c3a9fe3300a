#!/usr/bin/env python3
"""Lets clients upload, localize, merge and delete for a long time on one server, which must neither fail nor grow.

  soak.py [--seconds 3600] [--seed 1]
  soak.py --slow-clients               slow_clients.py against a server with a map

The clients are those of kill_nine.py, and what the server has is compared with what they were answered at the end, and
by check after it was stopped. Memory is measured every tenth part: over the last half it may rise by 10 % at most. Exits
with 1 when it does, when an answer is 5xx, or when something is lost.
"""

import argparse
import random
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import server_process
from kill_nine import MapClient, MergeClient
from ledger import MapLedger
from slow_clients import open_files, rss_mib

RISE = 1.1


def slow_clients(folder, robots):
    server = server_process.Server(folder / "data")
    known = MapLedger("lab")
    known.create(server)
    known.upload_batch(server, [(f"p{i}", picture) for i, picture in enumerate(robots[0][:20])])
    image = folder / "query.jpg"
    image.write_bytes(robots[1][0])
    script = Path(__file__).with_name("slow_clients.py")
    result = subprocess.run([sys.executable, str(script), "--port", str(server.port), "--pid", str(server.pid), "--map",
                             "lab", "--image", str(image)], check=False)
    return [] if server.stop() == 0 and result.returncode == 0 else ["slow clients are noticed by others"]


def soak(folder, robots, seconds, seed):
    rng = random.Random(seed)
    server = server_process.Server(folder / "data", ["--cache-mb", "64"])
    clients = [MapClient(f"map{i}", random.Random(rng.random()), robots[0] + robots[1]) for i in range(3)]
    clients.append(MergeClient("merged", random.Random(rng.random()), robots))
    until = time.monotonic() + seconds
    lost = []

    def run(client):
        try:
            while time.monotonic() < until:
                client.note(*client.step(server))
        except (server_process.NoAnswer, RuntimeError) as error:
            lost.append(str(error))

    threads = [threading.Thread(target=run, args=(client,), daemon=True) for client in clients]
    for thread in threads:
        thread.start()
    memory_mib = []
    for tenth in range(1, 11):
        while time.monotonic() < until - seconds * (10 - tenth) / 10 and server.running():
            time.sleep(0.1)
        if not server.running():
            return [f"the server ended by itself with {server.process.returncode}"]
        memory_mib.append(rss_mib(server.pid))
    for thread in threads:
        thread.join()
    for client in clients:
        client.agree(server)
    files = open_files(server.pid)
    if server.stop() != 0:
        lost.append("it does not stop")
    lost += filter(None, [server_process.check(folder / "data")])
    lost += [text for client in clients for ledger in client.ledgers for text in ledger.violations]
    lost += [f"{number} answers {code}" for client in clients for code, number in client.refused.items() if code[0] == "5"]
    if memory_mib[-1] > RISE * max(memory_mib[4:7]):
        lost.append("its memory grows")
    print(f"soak: {seconds} s, {sum(client.answered for client in clients)} writes answered, memory "
          f"{', '.join(f'{mib:.0f}' for mib in memory_mib)} MiB, {files} files open at the end, {len(lost)} violations, "
          f"seed {seed}")
    return lost


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=3600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slow-clients", action="store_true")
    args = parser.parse_args()
    folder = server_process.new_folder("soak")
    robots = server_process.rendered_images(folder / "world", 40)
    lost = slow_clients(folder, robots) if args.slow_clients else soak(folder, robots, args.seconds, args.seed)
    for text in lost:
        print(text, file=sys.stderr)
    if lost:
        print(f"left in {folder}", file=sys.stderr)
        sys.exit(1)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
