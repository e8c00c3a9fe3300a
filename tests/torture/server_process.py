"""A mapweld-server of a test's own, and requests to it.

Start servers from the main thread alone: a server is killed when the thread that started it ends.
"""

import ctypes
import http.client
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

START_WITHIN_S = 120
ANSWER_WITHIN_S = 120


class NoAnswer(Exception):
    """The connection ended before there was a whole answer: whether the request counts, nobody can know."""


class DidNotStart(Exception):
    """The server ended, or was ended, before it listened."""

    def __init__(self, code):
        super().__init__(f"the server ended with {code} before it listened")
        self.code = code


def binaries(preset="release"):
    return Path(os.environ.get("MAPWELD_BIN", Path(__file__).resolve().parents[2] / "build" / preset / "bin"))


def new_folder(name):
    """A folder of one's own under TMPDIR, on a disk and not in memory: syncing shall mean something."""
    return Path(tempfile.mkdtemp(prefix=f"mapweld-{name}-", dir=os.environ.get("TMPDIR", "/var/tmp")))


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Server:
    """`mapweld-server serve` on `folder`. What it says goes to `folder`.log."""

    def __init__(self, folder, options=(), environment=(), binary=None, kill_after_s=None):
        self.folder = Path(folder)
        self.binary = str(binary or binaries() / "mapweld-server")
        self.log = open(str(folder) + ".log", "ab")
        self.process = subprocess.Popen(
            [self.binary, "serve", "--data", str(folder), "--port", "0", "--log-level", "warning", *options],
            stdout=subprocess.PIPE, stderr=self.log, env={**os.environ, **dict(environment)},
            preexec_fn=die_with_parent)
        self.pid = self.process.pid
        deadline = time.monotonic() + (START_WITHIN_S if kill_after_s is None else kill_after_s)
        said = b""
        while b"\n" not in said:
            ready, _, _ = select.select([self.process.stdout], [], [], max(0, deadline - time.monotonic()))
            piece = os.read(self.process.stdout.fileno(), 4096) if ready else b""
            if not piece:
                if ready:  # it has closed its output: it ends by itself
                    code = self.process.wait()
                else:
                    self.kill()
                    code = -signal.SIGKILL
                self.close()
                raise DidNotStart(code)
            said += piece
        self.port = int(said.split(b"\n")[0].rsplit(b":", 1)[1])

    def running(self):
        return self.process.poll() is None

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.close()

    def stop(self, within_s=30):
        """Its exit code after SIGTERM, below 0 the signal that ended it; None when it had to be killed."""
        self.process.terminate()
        try:
            code = self.process.wait(within_s)
        except subprocess.TimeoutExpired:
            self.kill()
            return None
        self.close()
        return code

    def close(self):
        self.process.stdout.close()
        self.log.close()

    def request(self, method, path, body=None, content_type=None, key=None):
        """(status, document or bytes) of one request on a connection of its own."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=ANSWER_WITHIN_S)
        try:
            if isinstance(body, dict):
                body = json.dumps(body)
            headers = {"Content-Type": content_type} if content_type else {}
            if key:
                headers["Idempotency-Key"] = key
            connection.request(method, path, body=body, headers=headers)
            reply = connection.getresponse()
            content = reply.read()
            kind = reply.headers.get("Content-Type", "")
        except (OSError, http.client.HTTPException) as error:
            raise NoAnswer(f"{method} {path}: {error!r}") from error
        finally:
            connection.close()
        if "json" in kind and content:
            return reply.status, json.loads(content)
        return reply.status, content

    def items(self, path):
        """All items of a paged list; None when there is no such list."""
        items = []
        cursor = ""
        while True:
            status, page = self.request("GET", f"{path}?limit=1000{cursor}")
            if status == 404:
                return None
            if status != 200:
                raise RuntimeError(f"GET {path}: {status} {page}")
            items += page["items"]
            if page["next_cursor"] is None:
                return items
            cursor = "&cursor=" + page["next_cursor"]


def check(folder, options=()):
    """What `mapweld-server check` finds; empty when all is in order."""
    result = subprocess.run([str(binaries() / "mapweld-server"), "check", "--data", str(folder), *options],
                            capture_output=True, text=True, check=False)
    return "" if result.returncode == 0 else f"check exits with {result.returncode}: {result.stdout}{result.stderr}"


def rendered_images(folder, number=60, seed=5):
    """Two robots' images of one made-up building, as lists of bytes."""
    subprocess.run([str(binaries() / "render-sample-world"), "--out", str(folder), "--images-a", str(number),
                    "--images-b", str(number), "--queries", "1", "--seed", str(seed)], check=True,
                   stdout=subprocess.DEVNULL)
    robots = sorted(path for path in Path(folder).iterdir() if path.is_dir() and path.name.startswith("robot"))
    images = [[file.read_bytes() for file in sorted(robot.glob("*.jpg"))] for robot in robots]
    shutil.rmtree(folder)
    return images
