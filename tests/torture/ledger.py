"""What clients were answered about a map, and what a server has of it: nothing that was answered may be missing, and
nothing may be there that was not sent, or that was answered with an error."""

import hashlib
import random
import struct
import uuid
import zlib


def sha256(content):
    return hashlib.sha256(content).hexdigest()


def with_comment(jpeg, comment):
    """The same picture in other bytes."""
    text = comment.encode()
    return jpeg[:2] + b"\xff\xfe" + struct.pack(">H", len(text) + 2) + text + jpeg[2:]


def mask_png(width_px, height_px, black_rows):
    """A PNG, white but for its first rows."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    rows = b"".join(b"\0" + (b"\0" if y < black_rows else b"\xff") * width_px for y in range(height_px))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width_px, height_px, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def multipart(parts):
    """(body, content type) of a batch of (name or None, bytes)."""
    boundary = "torture" + "%016x" % random.getrandbits(64)
    body = b""
    for name, content in parts:
        file_name = f'; filename="{name}"' if name else ""
        body += (f'--{boundary}\r\nContent-Disposition: form-data; name="i"{file_name}\r\n\r\n').encode()
        body += content + b"\r\n"
    return body + f"--{boundary}--\r\n".encode(), f"multipart/form-data; boundary={boundary}"


UNKNOWN = object()


class Posts:
    """POSTs, each under an Idempotency-Key of its own. One without an answer is sent again before anybody looks: it must
    count once, and be answered as if nothing had happened."""

    unanswered = None

    def post(self, server, path, body, content_type, take):
        """`take(server, status, reply)` hears the answer of whichever server, now or after `again`, and returns what this
        does."""
        self.unanswered = (path, body, content_type, uuid.uuid4().hex, take)
        return self.again(server)

    def again(self, server):
        if self.unanswered is None:
            return None
        path, body, content_type, key, take = self.unanswered
        status, reply = server.request("POST", path, body, content_type, key)
        self.unanswered = None
        return take(server, status, reply)


class MapLedger(Posts):
    """One map by its name. One client at a time writes it, so that the order of its requests is known; one that is no
    POST and got no answer leaves what it would change UNKNOWN until `agree` has looked."""

    def __init__(self, name):
        self.name = name
        self.path = f"/v1/maps/{name}"
        self.violations = []
        self.forget()
        self.exists = False

    def forget(self):
        self.uuid = None
        self.images = {}  # name: (bytes, vertex or None when it is ignored)
        self.mask = None  # bytes, None, or UNKNOWN and then possible_masks
        self.possible_masks = []
        self.unasked = set()  # names of images that were there against what was answered, told once
        self.looked_at = set()  # names whose bytes have been compared since they were answered

    def say(self, what):
        self.violations.append(f"{self.name}: {what}")

    # Each of these sends one request, remembers what the answer promises, and lets NoAnswer pass.

    def create(self, server):
        self.forget()
        self.uuid = str(uuid.uuid4())
        self.exists = UNKNOWN

        def take(_, status, reply):
            self.exists = status == 201
            if status == 409:
                self.say("is made twice")
            return status, reply

        return self.post(server, "/v1/maps", {"name": self.name, "uuid": self.uuid}, None, take)

    def delete(self, server):
        before = self.exists
        self.exists = UNKNOWN
        status, reply = server.request("DELETE", self.path)
        self.exists = False if status == 204 else before
        return status, reply

    def upload(self, server, name, content):
        """Without a name, nothing but its key keeps an image from being there twice."""
        def take(_, status, reply):
            if status in (200, 201):
                self.answered(name, content, reply)
            return status, reply

        query = f"name={name}&" if name else ""
        return self.post(server, f"{self.path}/images?{query}map_uuid={self.uuid}", content, "image/jpeg", take)

    def upload_batch(self, server, parts):
        """`parts`: (name or None, bytes) each. The status of each part, or the one of all of them."""
        def take(_, status, reply):
            if status != 200:
                return [status]
            for (name, content), item in zip(parts, reply["items"], strict=True):
                if "outcome" in item:
                    self.answered(name, content, item)
            return [200 if "outcome" in item else item["status"] for item in reply["items"]]

        return self.post(server, f"{self.path}/images/batch?map_uuid={self.uuid}", *multipart(parts), take)

    def answered(self, name, content, outcome):
        if name is None:
            name = outcome["name"]
            if name in self.images:
                self.say(f"{name} is the name of two images")
        if outcome["name"] != name:
            self.say(f"{name} is answered as {outcome['name']}")
        vertex = outcome["vertex"] if outcome["outcome"] == "inserted" else None
        known = self.images.get(name)
        if known is not None and known != (content, vertex):
            self.say(f"{name} was vertex {known[1]} and is {vertex} when it is sent again")
        self.images[name] = (content, vertex)

    def put_mask(self, server, content):
        return self.change_mask(content, *self.masking("PUT", server, content))

    def delete_mask(self, server):
        return self.change_mask(None, *self.masking("DELETE", server, None))

    def masking(self, method, server, content):
        before = self.possible_masks if self.mask is UNKNOWN else [self.mask]
        self.possible_masks = [*before, content]
        self.mask = UNKNOWN
        return (before, *server.request(method, f"{self.path}/mask", content, "image/png" if content else None))

    def change_mask(self, content, before, status, reply):
        if status == 204:
            self.mask = content
        elif len(before) == 1:
            self.mask = before[0]
        else:
            self.possible_masks = before
        return status, reply

    def agree(self, server, rng, samples=4):
        """Compares all that `server` has of the map with what was answered, the bytes of images that were not looked at
        before and of some others; then knows what was unknown. Adds to `violations`."""
        self.again(server)
        status, found = server.request("GET", self.path)
        if status == 404:
            if self.exists is True:
                self.say(f"is lost, with {len(self.images)} images")
            self.exists = False
            return
        if status != 200:
            self.say(f"GET answers {status} {found}")
            return
        if self.exists is False:
            self.say("is there although it was deleted, or never made")
        self.exists = True
        if found["uuid"] != self.uuid:
            self.say(f"has uuid {found['uuid']} instead of {self.uuid}")
            return
        self.agree_on_images(server, rng, samples, found)
        self.agree_on_mask(server)

    def agree_on_images(self, server, rng, samples, found):
        listed = {item["name"]: (item["sha256"], item["vertex"]) for item in server.items(f"{self.path}/vertices")}
        vertices = len(listed)
        ignored = {item["name"]: (item["sha256"], None) for item in server.items(f"{self.path}/ignored")}
        if listed.keys() & ignored.keys():
            self.say(f"has {sorted(listed.keys() & ignored.keys())} twice")
        listed.update(ignored)
        if (found["vertices"], found["ignored"]) != (vertices, len(ignored)):
            self.say(f"counts {found['vertices']} and {found['ignored']} images, lists {vertices} and {len(ignored)}")
        for name, (content, vertex) in self.images.items():
            if name not in listed:
                self.say(f"image {name}, vertex {vertex}, is lost")
            elif listed[name] != (sha256(content), vertex):
                self.say(f"image {name}, vertex {vertex}, is {listed[name]}")
        for name in listed.keys() - self.images.keys() - self.unasked:
            self.say(f"image {name} is there, which was never sent, answered with an error, or there before")
            self.unasked.add(name)
        inserted = [name for name, (_, vertex) in self.images.items() if vertex is not None and name in listed]
        new = [name for name in inserted if name not in self.looked_at]
        for name in new + rng.sample(inserted, min(samples, len(inserted))):
            content, vertex = self.images[name]
            if server.request("GET", f"{self.path}/vertices/{vertex}/image") != (200, content):
                self.say(f"the bytes of image {name} are not those that were sent")
            self.looked_at.add(name)

    def agree_on_mask(self, server):
        status, content = server.request("GET", f"{self.path}/mask")
        there = content if status == 200 else None
        possible = self.possible_masks if self.mask is UNKNOWN else [self.mask]
        if status not in (200, 404) or there not in possible:
            self.say(f"the mask is another ({status})")
        self.mask = there
