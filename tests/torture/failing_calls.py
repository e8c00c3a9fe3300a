#!/usr/bin/env python3
"""Lets system calls and allocations of a server fail, the 1st, 2nd, ... Nth one, once and for ever, while it takes
uploads, merges, is backed up, deletes, starts and stops.

  failing_calls.py [--each 4] [--seed 1] [--operations upload merge ...] [--kinds sync memory ...]

Of each operation, kind of call and error, --each values of N are tried, twice: the first ones and some of all that an
undisturbed run makes; --each 0 tries all N, of allocations 300. Each time the server must live, every request be
answered (a connection for which there is no memory is closed instead), and afterwards the server, and one that starts
on the folder without failures, have all that was answered and nothing that was refused; then `mapweld-server check`
reads everything. Exits with 1 when a promise is broken.
"""

import argparse
import errno
import mmap
import os
import random
import shutil
import struct
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import server_process
from ledger import MapLedger, mask_png, with_comment
from merge_ledger import AT_REST, MergeLedger

# As in failing_calls.c.
KINDS = {"write": 1, "sync": 2, "truncate": 3, "open": 4, "mmap": 5, "read": 6, "fallocate": 7, "unlink": 8,
         "rename": 9, "memory": 10}
ERRORS = {"write": [errno.EIO, errno.ENOSPC], "sync": [errno.EIO], "truncate": [errno.EIO], "open": [errno.EMFILE, errno.EIO],
          "mmap": [errno.ENOMEM], "read": [errno.EIO], "fallocate": [errno.ENOSPC], "unlink": [errno.EIO],
          "rename": [errno.EIO], "memory": [errno.ENOMEM]}
CONTROL = struct.Struct("=IIqqiIqq")
ALLOCATIONS_TRIED = 300
RESTART_EVERY = 8


class Shim:
    """What a process that is started with `environment` fails at."""

    def __init__(self, folder, name, library, under):
        self.file = folder / f"{name}.control"
        self.file.write_bytes(bytes(CONTROL.size))
        with open(self.file, "r+b") as file:
            self.memory = mmap.mmap(file.fileno(), CONTROL.size)
        self.environment = {"LD_PRELOAD": str(library), "FAILING_CALLS_CONTROL": str(self.file),
                            "FAILING_CALLS_UNDER": str(under)}

    def arm(self, kind, number, for_ever, error, min_bytes=0):
        self.disarm()
        CONTROL.pack_into(self.memory, 0, 0, for_ever, number, min_bytes, error, 0, 0, 0)
        struct.pack_into("=I", self.memory, 0, KINDS[kind])

    def disarm(self):
        """(calls seen, calls failed) since it was armed."""
        struct.pack_into("=I", self.memory, 0, 0)
        return CONTROL.unpack_from(self.memory)[6:]


class Torture:
    def __init__(self, args):
        self.rng = random.Random(args.seed)
        self.folder = server_process.new_folder("failing-calls")
        library = self.folder / "failing_calls.so"
        source = Path(__file__).with_name("failing_calls.c")
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-O2", "-o", library, source, "-ldl"], check=True)
        self.shim = Shim(self.folder, "server", library, self.folder)
        self.backup_shim = Shim(self.folder, "backup", library, self.folder)
        self.robots = server_process.rendered_images(self.folder / "world", 16)
        self.data = self.folder / "data"
        self.sources = [MapLedger(name) for name in ("left", "right")]
        self.scratch = MapLedger("scratch")
        self.uploads = MapLedger("uploads")
        self.merge = MergeLedger("merged", ["left", "right"])
        self.merge.may_fail = True
        self.server = None
        self.edges = None  # of the undisturbed merge
        self.sent = 0
        self.label = "at first"
        self.violations = []
        self.tried = Counter()
        self.failed = 0
        self.cut_off = 0
        self.answers = Counter()

    def say(self, what):
        self.violations.append(f"{self.label}: {what}")
        print(self.violations[-1], file=sys.stderr, flush=True)

    def content(self):
        self.sent += 1
        return with_comment(self.rng.choice(self.robots[0]), f"sent {self.sent}")

    def start(self):
        self.server = server_process.Server(self.data, ["--checkpoint-interval", "0.02"], self.shim.environment)

    # Operations: what stands before is prepared undisturbed, the rest is what may fail.

    def prepare(self, operation):
        if operation in ("upload", "batch", "mask"):
            if self.uploads.exists and len(self.uploads.images) > 40:
                self.uploads.delete(self.server)
            if not self.uploads.exists:
                self.uploads.create(self.server)
        elif operation == "delete":
            if not self.scratch.exists:
                self.scratch.create(self.server)
            if not self.scratch.images:
                self.scratch.upload_batch(self.server, [(f"s{i}", self.content()) for i in range(2)])
        elif operation == "create" and self.scratch.exists:
            self.scratch.delete(self.server)
        elif operation == "merge" and self.merge.exists:
            self.merge.delete(self.server)
        elif operation == "stop" and self.server is not None:
            self.uploads.exists or self.uploads.create(self.server)
            self.uploads.upload(self.server, f"i{self.sent}", self.content())
        elif operation == "start":
            self.server.kill()

    def run(self, operation):
        """Statuses of the answers."""
        server = self.server
        if operation == "upload":
            return [self.uploads.upload(server, f"i{self.sent}", self.content())[0]]
        if operation == "batch":
            parts = [(f"b{self.sent}", self.content()) for _ in range(3)]
            return self.uploads.upload_batch(server, parts)
        if operation == "mask":
            return [self.uploads.put_mask(server, mask_png(320, 240, self.rng.randrange(1, 99)))[0],
                    self.uploads.delete_mask(server)[0]]
        if operation == "create":
            return [self.scratch.create(server)[0]]
        if operation == "delete":
            return [self.scratch.delete(server)[0]]
        if operation == "localize":
            return [server.request("POST", "/v1/maps/left/localize", self.robots[1][0], "image/jpeg")[0]]
        if operation == "merge":
            statuses = [self.merge.submit(server, "quickconnect")[0]]
            until = time.monotonic() + 3
            while self.merge.exists is True and time.monotonic() < until:
                status, reply = server.request("GET", self.merge.path)
                statuses.append(status)
                if status == 200 and (reply["state"] in AT_REST or reply["stop_reason"] == "no_space"):
                    break
                time.sleep(0.01)
            return statuses
        if operation == "backup":
            return [self.back_up()]
        if operation == "start":
            return [self.start_disturbed()]
        if operation == "stop":
            code = server.stop()
            self.server = None
            if code is None or code < 0:
                self.say(f"SIGTERM ends it with {code}")
            return [200]
        raise ValueError(operation)

    def start_disturbed(self):
        self.server = None
        try:
            self.start()
            return 200
        except server_process.DidNotStart as error:
            if error.code <= 0:
                self.say(str(error))
            return 500

    def back_up(self):
        file = self.folder / "backup.mapweld"
        file.unlink(missing_ok=True)
        result = subprocess.run([self.server.binary, "backup", "--data", str(self.data), str(file)], check=False,
                                env={**os.environ, **self.backup_shim.environment}, capture_output=True, timeout=60)
        self.backup_shim.disarm()
        if result.returncode not in (0, 1, 2):
            self.say(f"backup exits with {result.returncode}: {result.stderr.decode()[-300:]}")
        if result.returncode != 0:
            if file.exists():
                self.say("backup failed and left a file")
            return 500
        restored = self.folder / "restored"
        shutil.rmtree(restored, ignore_errors=True)
        again = subprocess.run([self.server.binary, "restore", "--data", str(restored), str(file)], check=False,
                               capture_output=True, text=True, timeout=60)
        if again.returncode != 0:
            self.say(f"what backup made is not restored: {again.stdout}{again.stderr}")
        return 200

    def settle(self, operation):
        """Undisturbed again: what was begun can be finished."""
        if operation != "merge" or self.merge.exists is not True:
            return
        until = time.monotonic() + 30
        asked = 0
        while True:
            status, reply = self.server.request("GET", self.merge.path)
            if status != 200:
                self.say(f"the merge answers {status}")
                return
            if reply["state"] == "failed" and asked < 3:
                asked += 1
                self.server.request("POST", f"{self.merge.path}/resume")
            elif reply["state"] in AT_REST:
                break
            if time.monotonic() > until:
                self.say(f"the merge is {reply['state']} {reply['stop_reason']} for 30 s")
                return
            time.sleep(0.02)
        self.merge.rest = None
        if reply["state"] != "completed":
            self.say(f"the merge ends as {reply['state']}: {reply['error']}")
            return
        self.merge.look_at_edges(self.server)
        if self.edges is None:
            self.edges = self.merge.edges
        elif self.merge.edges != self.edges:
            self.say(f"the merge ends with {len(self.merge.edges)} edges, not {len(self.edges)}, or others")

    def agree(self):
        for ledger in (*self.sources, self.scratch, self.uploads):
            ledger.agree(self.server, self.rng, samples=1)
        self.merge.agree(self.server)
        for ledger in (*self.sources, self.scratch, self.uploads, self.merge):
            for text in ledger.violations:
                self.say(text)
            ledger.violations.clear()

    def again(self):
        """A server on the folder, undisturbed, after the one before was killed."""
        self.shim.disarm()
        if self.server is not None:
            self.server.kill()
        self.start()
        self.agree()

    def try_one(self, operation, kind, number, for_ever, error):
        self.label = f"{operation}, {kind} {number}{' and on' if for_ever else ''} {errno.errorcode[error]}"
        try:
            self.prepare(operation)
        except server_process.NoAnswer as problem:
            self.say(f"while preparing: {problem}")
            return 0
        shim = self.backup_shim if operation == "backup" else self.shim
        # For ever without any memory nothing can go on; without large pieces of it much can.
        shim.arm(kind, number, for_ever, error, 65536 if kind == "memory" and for_ever else 0)
        try:
            for status in self.run(operation):
                self.answers[status] += 1
                if number == 0 and status >= 300:
                    self.say(f"undisturbed, it answers {status}")
        except server_process.NoAnswer as problem:
            if not self.server.running():
                self.say(f"the server ended with {self.server.process.returncode}")
            elif kind == "memory":
                self.cut_off += 1
            else:
                self.say(f"no answer ({problem})")
        seen, failed = shim.disarm()
        self.failed += failed
        self.tried[kind] += 1
        lives = self.server is not None and self.server.running()
        if not lives and operation not in ("start", "stop"):
            self.say(f"the server is gone, with {self.server.process.returncode}")
        try:
            if lives:
                self.settle(operation)
                self.agree()
            if not lives or for_ever or self.rng.randrange(RESTART_EVERY) == 0:
                self.again()
        except (server_process.NoAnswer, server_process.DidNotStart, RuntimeError) as problem:
            self.say(f"afterwards: {problem}")
            self.again()
        return seen

    def numbers(self, kind, seen, each):
        if each == 0:
            each = ALLOCATIONS_TRIED if kind == "memory" else seen
        if seen <= each:
            return list(range(1, seen + 1))
        first = list(range(1, each // 2 + 1))
        return first + sorted(self.rng.sample(range(each // 2 + 1, seen + 1), each - len(first)))

    def torture(self, operations, kinds, each):
        self.start()
        for source, pictures in zip(self.sources, self.robots):
            source.create(self.server)
            source.upload_batch(self.server, [(f"p{i}", picture) for i, picture in enumerate(pictures)])
        for operation in operations:
            for kind in kinds:
                if kind == "memory" and operation in ("backup", "start", "stop"):
                    continue  # without memory for their libraries processes neither begin nor end
                self.try_one(operation, kind, 0, 0, errno.EIO)  # caches are warm then
                seen = self.try_one(operation, kind, 0, 0, errno.EIO)
                for error in ERRORS[kind]:
                    for number in self.numbers(kind, seen, each):
                        for for_ever in (0, 1):
                            self.try_one(operation, kind, number, for_ever, error)
            self.label = f"after {operation}"
            finding = server_process.check(self.data)
            if finding:
                self.say(finding)
        self.label = "at the end"
        if self.server.stop() != 0:
            self.say("it does not stop")
        finding = server_process.check(self.data)
        if finding:
            self.say(finding)


OPERATIONS = ("upload", "batch", "mask", "create", "localize", "merge", "backup", "delete", "start", "stop")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--each", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--operations", nargs="+", choices=OPERATIONS, default=OPERATIONS)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    args = parser.parse_args()
    started = time.monotonic()
    server_process.ANSWER_WITHIN_S = 30
    torture = Torture(args)
    torture.torture(args.operations, args.kinds, args.each)
    print(f"failing_calls: {sum(torture.tried.values())} runs, {torture.failed} calls failed, "
          f"answers {dict(sorted(torture.answers.items()))}, {torture.cut_off} connections closed instead, {len(torture.violations)} violations, "
          f"{time.monotonic() - started:.0f} s, seed {args.seed}")
    if torture.violations:
        print(f"left in {torture.folder}", file=sys.stderr)
        sys.exit(1)
    shutil.rmtree(torture.folder)


if __name__ == "__main__":
    main()
