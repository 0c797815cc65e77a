"""A warehouse system with the client that is generated from /openapi.json: a thousand jobs in a batch, their events
followed over three kills of the server, and at the end the books of the system are those of the server.

python tests/client_kills.py PATH-TO-GIVEWAY FOLDER-OF-THE-CLIENT FOLDER-FOR-THE-DATABASE
"""

import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from importlib import import_module
from pathlib import Path

import httpx

program, folder, scratch = sys.argv[1:]
sys.path.insert(0, folder)
package = import_module("giveway_client")
models = import_module("giveway_client.models")

JOBS = 1000
KILLS = 3
OVER = {"done", "cancelled", "failed"}
SCENARIO = Path(__file__).parent / "it" / "quiet.json"
PATIENCE_S = 300
QUIET = {**os.environ, "RUST_LOG": "error"}


def call(tag, operation):
    return import_module(f"giveway_client.api.{tag}.{operation}").sync


class Server:
    """The program itself, on a database that outlasts it."""

    def __init__(self, database):
        arguments = ["serve", "--scenario", str(SCENARIO), "--listen", "127.0.0.1:0", "--database", database]
        self.process = subprocess.Popen([program, *arguments], stdout=subprocess.PIPE, text=True, env=QUIET)
        for line in self.process.stdout:
            found = re.match(r"Giveway is at (http://[^/]+)/$", line)
            if found:
                break
        else:
            raise SystemExit("the server did not start")
        threading.Thread(target=self.process.stdout.read, daemon=True).start()
        self.client = package.Client(base_url=found[1], timeout=httpx.Timeout(20))

    def kill(self):
        self.process.kill()
        self.process.wait()


class Books:
    """What the warehouse system knows: the state of each job, and the last event that it has dealt with."""

    def __init__(self):
        self.last = 0
        self.states = {}

    def follow(self, client):
        """Takes in the events that there are now."""
        page = call("events", "list_events")(client=client, after=self.last, kind="job", limit=500)
        assert isinstance(page, models.EventPage), page
        for event in page.items:
            assert event.seq > self.last, f"{event.seq} after {self.last}"
            before = self.states.get(event.id)
            assert event.old == before, f"{event.id} was {event.old}, and not {before}: an event was missed"
            self.states[event.id], self.last = event.new, event.seq
        self.last = max(self.last, page.next_)

    def are_over(self):
        return len(self.states) == JOBS and OVER.issuperset(self.states.values())


def cancel(client, ids):
    """Cancels jobs until the server is gone."""
    for job in ids:
        try:
            call("jobs", "cancel_job")(job, client=client)
        except httpx.HTTPError:
            return


def listed(client):
    """What the server's own list says of each job."""
    states, cursor = {}, package.types.UNSET
    while True:
        page = call("jobs", "list_jobs")(client=client, limit=500, cursor=cursor)
        states |= {job.id: job.state.value for job in page.items}
        if page.next_ is None:
            return states
        cursor = page.next_


def submit(client):
    racks = call("floor", "list_racks")(client=client).items
    station = call("floor", "list_stations")(client=client, limit=1).items[0]

    def row(number):
        rack = racks[number % len(racks)].id
        job = models.NewJob(
            kind=models.JobKindDto.DELIVER, rack=rack, station=station.id, pick_s=0.1, reference=f"order {number}"
        )
        return models.BatchRow(job=job)

    batch = models.NewJobs(jobs=[row(number) for number in range(JOBS)])
    made = call("jobs", "submit_jobs")(client=client, body=batch)
    assert made.accepted == JOBS, made


def main():
    with tempfile.TemporaryDirectory(dir=scratch) as place:
        database = f"{place}/wms.sqlite"
        server, books = Server(database), Books()
        try:
            submit(server.client)
            for kill in range(KILLS):
                # Most jobs are cancelled while robots work on others, so that a kill comes amid changes.
                ids = [f"j{number}" for number in range(kill * 330 + 1, kill * 330 + 329)]
                cancels = threading.Thread(target=cancel, args=(server.client, ids))
                cancels.start()
                end = time.monotonic() + 1.5
                while time.monotonic() < end:
                    books.follow(server.client)
                server.kill()
                cancels.join()
                server = Server(database)
            cancel(server.client, [f"j{number}" for number in range(1, JOBS - 4)])
            end = time.monotonic() + PATIENCE_S
            while not books.are_over():
                assert time.monotonic() < end, f"not all jobs end: {len(books.states)}"
                books.follow(server.client)
                time.sleep(0.1)
            states = listed(server.client)
        finally:
            server.kill()
    assert states == books.states, "the books differ"
    assert "done" in states.values(), "some were done"
    print(f"pass: a generated client followed {JOBS} jobs over {KILLS} kills and has the books of the server")


main()
