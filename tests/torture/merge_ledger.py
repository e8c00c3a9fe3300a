"""What clients were told about merges of two maps, and what a server has of them."""

from ledger import UNKNOWN, Posts

AT_REST = {"paused", "budget_exhausted", "completed", "cancelled", "failed"}
REST_AFTER = {"pause": "paused", "cancel": "cancelled"}


def edge_key(edge):
    return tuple(edge[field] for field in ("u", "v", "votes", "inliers", "verifications"))


class MergeLedger(Posts):
    """One merge after the other, of the same maps, by one client."""

    def __init__(self, name, maps):
        self.name = name
        self.maps = maps
        self.violations = []
        self.may_fail = False  # something is made to fail
        self.forget()
        self.exists = False

    def forget(self):
        self.id = None
        self.rest = None  # the state it was told to rest in, and nobody has asked for more since
        self.furthest_step = 0  # of the checkpoints that were told
        self.edges = []  # as they were listed; more may follow, none may change
        self.perhaps_restarted = False

    @property
    def path(self):
        return f"/v1/merges/{self.id}"

    def say(self, what):
        self.violations.append(f"merge {self.id} ({self.name}): {what}")

    def submit(self, server, method, budget=None):
        self.forget()
        self.exists = UNKNOWN
        request = {"maps": self.maps, "name": self.name, "method": method, "parameters": {"min_votes": 1}}
        if budget:
            request["budget"] = budget

        def take(_, status, reply):
            self.exists = status == 202
            if status == 202:
                self.id = reply["id"]
                self.told(reply)
            elif reply["code"] == "name_taken":
                self.say("is begun twice")
            return status, reply

        return self.post(server, "/v1/merges", request, None, take)

    def command(self, server, what):
        """pause, resume, restart or cancel."""
        before = self.rest
        self.rest = None
        if what == "restart":
            self.perhaps_restarted = True
            edges = self.edges
            self.edges = []

        def take(answering, status, reply):
            if what == "restart":
                self.perhaps_restarted = False
                if status == 202:
                    self.furthest_step = 0
                else:
                    self.edges = edges
            if status == 202:
                self.told(reply)
                if what in ("pause", "cancel") and reply["state"] not in AT_REST:
                    self.say(f"{what} is answered with state {reply['state']}")
            else:
                self.rest = before
                if before is None and what in REST_AFTER:
                    self.expect_other(answering, REST_AFTER[what], reply)
            return status, reply

        return self.post(server, f"{self.path}/{what}", None, None, take)

    def expect_other(self, server, state, refusal):
        """A merge that moved and was refused to be brought to `state`: nobody but that request could have done so."""
        if server.request("GET", self.path)[1].get("state") == state:
            self.say(f"is {state}, and the one who asked for that is told {refusal['code']}")

    def delete(self, server):
        self.exists = UNKNOWN
        status, reply = server.request("DELETE", self.path)
        self.exists = status != 204
        return status, reply

    def look(self, server):
        status, reply = server.request("GET", self.path)
        if status == 200:
            self.told(reply)
        elif self.exists is True:
            self.say(f"GET answers {status}")
        return status, reply

    def told(self, merge):
        checkpoint = merge["checkpoint"]
        step = checkpoint["step"] if checkpoint else 0
        if self.perhaps_restarted:
            self.furthest_step = 0
        if step < self.furthest_step:
            self.say(f"its checkpoint was at step {self.furthest_step} and is at {step}")
        self.furthest_step = max(self.furthest_step, step)
        self.perhaps_restarted = False
        if merge["state"] == "failed" and not self.may_fail:
            self.say(f"failed: {merge['error']}")
        if self.rest is not None and merge["state"] != self.rest:
            self.say(f"rested as {self.rest} and is {merge['state']}")
        self.rest = merge["state"] if merge["state"] in AT_REST else None

    def look_at_edges(self, server):
        edges = [edge_key(edge) for edge in server.items(f"{self.path}/edges") or []]
        if edges[:len(self.edges)] != self.edges:
            self.say(f"its first {len(self.edges)} edges have changed, of {len(edges)} now")
        self.edges = edges

    def agree(self, server):
        self.again(server)
        if self.id is None:  # the answer would have said its number
            named = [merge for merge in server.items("/v1/merges") if merge["map"] == self.name]
            if len(named) > 1 or (named and self.exists is False):
                self.say(f"is there {len(named)} times, and was answered with an error")
            self.exists = bool(named)
            if not named:
                if server.request("GET", f"/v1/maps/{self.name}")[0] != 404:
                    self.say("its map is there without it")
                return
            self.id = named[0]["id"]
        status, merge = server.request("GET", self.path)
        map_status = server.request("GET", f"/v1/maps/{self.name}")[0]
        if map_status != status:
            self.say(f"answers {status}, its map {map_status}")
        if status == 404:
            if self.exists is True:
                self.say("is lost")
            self.exists = False
            return
        if status != 200:
            self.say(f"GET answers {status} {merge}")
            return
        if self.exists is False:
            self.say("is there although it was deleted")
        self.exists = True
        self.told(merge)
        self.look_at_edges(server)
