#!/usr/bin/env python3
"""Kills a server with SIGKILL at random moments, some answers after its start, while clients change maps and merges, starts
it again, sends what got no answer again under the same idempotency key, and compares what it has with what the clients
were answered: nothing lost, nothing twice.

  kill_nine.py [--rounds 100] [--seed 1] [--folder DIR] [--cut-wal]

Every tenth round and at the end `mapweld-server check` reads everything, before a server has touched what the kill left
or beside one. Some kills hit a server that starts. Exits with 1 when anything is lost, changed or there unasked.
--cut-wal shortens the write-ahead log after each kill, and so must end with 1: what the comparison is worth.
"""

import argparse
import os
import random
import shutil
import sys
import threading
import time
from pathlib import Path

import server_process
from ledger import MapLedger, mask_png, with_comment
from merge_ledger import MergeLedger

OPTIONS = ["--checkpoint-interval", "0.02", "--cache-mb", "64"]
LARGEST_MAP = 80


class Client:
    """Sends requests until the server is gone."""

    def __init__(self, name, rng, pictures):
        self.name = name
        self.rng = rng
        self.pictures = pictures
        self.answered = 0  # writes that were answered with success
        self.unanswered = 0
        self.refused = {}  # error: how often
        self.sent = 0

    def content(self):
        self.sent += 1
        return with_comment(self.rng.choice(self.pictures), f"{self.name} {self.sent}")

    def run(self, server):
        try:
            while True:
                self.note(*self.step(server))
        except server_process.NoAnswer:
            self.unanswered += 1

    def note(self, status, reply):
        if 200 <= status < 300:
            self.answered += 1
        else:
            code = f"{status} {reply['code']}" if isinstance(reply, dict) else str(status)
            self.refused[code] = self.refused.get(code, 0) + 1


class MapClient(Client):
    def __init__(self, name, rng, pictures):
        super().__init__(name, rng, pictures)
        self.map = MapLedger(name)
        self.ledgers = [self.map]

    def step(self, server):
        rng, known = self.rng, self.map
        if known.exists is not True:
            return known.create(server)
        draw = rng.random()
        if len(known.images) > LARGEST_MAP or draw < 0.01:
            return known.delete(server)
        if draw < 0.05:
            return known.put_mask(server, mask_png(320, 240, rng.randrange(1, 200)))
        if draw < 0.07:
            return known.delete_mask(server)
        if draw < 0.12:
            return server.request("POST", f"{known.path}/localize", rng.choice(self.pictures), "image/jpeg")
        if draw < 0.17 and known.images:  # again
            name = rng.choice(list(known.images))
            return known.upload(server, name, known.images[name][0])
        if draw < 0.3:
            parts = [(self.image_name("b"), self.content()) for _ in range(rng.randrange(2, 6))]
            statuses = known.upload_batch(server, parts)
            return max(statuses), {"code": "in_batch"}
        return known.upload(server, self.image_name("i"), self.content())

    def image_name(self, letter):
        """Of the next image; none for one in three, which the server names."""
        return f"{letter}{self.sent}" if self.rng.random() < 2 / 3 else None

    def agree(self, server):
        self.map.agree(server, self.rng)


class MergeClient(Client):
    """Merges two maps that grow a little."""

    def __init__(self, name, rng, robots):
        super().__init__(name, rng, robots[0] + robots[1])
        self.sources = [MapLedger(f"{name}-{side}") for side in "lr"]
        self.robots = robots
        self.merge = MergeLedger(name, [source.name for source in self.sources])
        self.ledgers = [*self.sources, self.merge]

    def step(self, server):
        rng, merge = self.rng, self.merge
        for source, pictures in zip(self.sources, self.robots):
            if source.exists is not True:
                return source.create(server)
            if len(source.images) < len(pictures):
                missing = [i for i in range(len(pictures)) if f"p{i}" not in source.images][:8]
                return max(source.upload_batch(server, [(f"p{i}", pictures[i]) for i in missing])), {"code": "in_batch"}
        if merge.exists is not True:
            budget = rng.choice([None, None, {"seconds": 0.05}, {"verifications": 100}])
            return merge.submit(server, rng.choice(["spectral", "quickconnect", "brute-force"]), budget)
        draw = rng.random()
        if draw < 0.3:
            time.sleep(0.02)
            return merge.look(server)
        if draw < 0.4:
            merge.look_at_edges(server)
            return merge.look(server)
        if draw < 0.6:
            return merge.command(server, "resume")
        if draw < 0.75:
            return merge.command(server, "pause")
        if draw < 0.87:
            return merge.command(server, "restart")
        if draw < 0.89:
            return merge.command(server, "cancel")
        if draw < 0.93:
            return merge.delete(server)
        source = rng.choice(self.sources)
        if len(source.images) > LARGEST_MAP:
            return merge.look(server)
        return source.upload(server, f"g{self.sent}", self.content())

    def agree(self, server):
        for source in self.sources:
            source.agree(server, self.rng)
        self.merge.agree(server)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--check-every", type=int, default=10)
    parser.add_argument("--folder", help="made, and left behind when something is wrong")
    parser.add_argument("--cut-wal", action="store_true")
    args = parser.parse_args()
    rng = random.Random(args.seed)
    folder = Path(args.folder) if args.folder else server_process.new_folder("kill-nine")
    folder.mkdir(parents=True, exist_ok=True)
    robots = server_process.rendered_images(folder / "world", 40)
    clients = [MapClient(f"map{i}", random.Random(rng.random()), robots[0] + robots[1]) for i in range(3)]
    clients.append(MergeClient("merged", random.Random(rng.random()), robots))
    ledgers = [ledger for client in clients for ledger in client.ledgers]
    violations = []
    started = time.monotonic()
    checks = starting = kills = 0

    while kills < args.rounds and not violations:
        data = folder / "data"
        checked = kills > 0 and kills % args.check_every == 0
        beside = rng.random() < 0.5
        if checked and not beside:
            violations += filter(None, [server_process.check(data)])
            checks += 1
        try:
            server = server_process.Server(data, OPTIONS, kill_after_s=rng.uniform(0, 0.2) if rng.random() < 0.1 else None)
        except server_process.DidNotStart as error:
            if error.code != -9:
                violations.append(f"round {kills}: {error}")
            starting += 1
            kills += 1
            continue
        try:
            for client in clients:
                client.agree(server)
        except (server_process.NoAnswer, RuntimeError) as error:
            violations.append(f"nobody had killed it (exit code {server.process.poll()}), and {error}")
        if checked and beside:
            violations += filter(None, [server_process.check(data)])
            checks += 1
        violations += [text for ledger in ledgers for text in ledger.violations]
        if violations:
            server.kill()
            break
        threads = [threading.Thread(target=client.run, args=(server,), daemon=True) for client in clients]
        for thread in threads:
            thread.start()
        enough = sum(client.answered for client in clients) + rng.randrange(12)
        latest = time.monotonic() + 10
        while sum(client.answered for client in clients) < enough and time.monotonic() < latest and server.running():
            time.sleep(0.005)
        time.sleep(rng.uniform(0, 0.2))
        if not server.running():
            violations.append(f"round {kills}: the server ended by itself with {server.process.returncode}")
        server.kill()
        kills += 1
        for thread in threads:
            thread.join()
        violations += [text for ledger in ledgers for text in ledger.violations]
        if args.cut_wal:
            wal = data / "mapweld.db-wal"
            os.truncate(wal, wal.stat().st_size // 2)

    if not violations:
        server = server_process.Server(folder / "data", OPTIONS)
        for client in clients:
            client.agree(server)
        if server.stop() != 0:
            violations.append("it does not stop")
        violations += filter(None, [server_process.check(folder / "data")])
        violations += [text for ledger in ledgers for text in ledger.violations]
    refused = {}
    for client in clients:
        for code, number in client.refused.items():
            refused[code] = refused.get(code, 0) + number
    violations += [f"{number} answers {code}" for code, number in refused.items() if code.startswith("5")]
    for text in violations:
        print(text, file=sys.stderr)
    print(f"kill_nine: {kills} kills ({starting} while starting), {checks + 1} checks, "
          f"{sum(client.answered for client in clients)} writes answered, "
          f"{sum(client.unanswered for client in clients)} cut off, {len(violations)} violations, "
          f"{time.monotonic() - started:.0f} s, seed {args.seed}; refused: {refused}")
    if violations:
        print(f"left in {folder}", file=sys.stderr)
        sys.exit(1)
    shutil.rmtree(folder)
    Path(str(folder) + ".log").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
