"""The Python client that is generated from /openapi.json, used as a customer would use it.

python tests/client.py http://127.0.0.1:8080 FOLDER-OF-THE-CLIENT
"""

import sys
from importlib import import_module

url, folder = sys.argv[1:]
sys.path.insert(0, folder)
client = import_module("giveway_client").Client(base_url=url)
models = import_module("giveway_client.models")
call = import_module


def of(tag, operation):
    return call(f"giveway_client.api.{tag}.{operation}")


rack = of("floor", "list_racks").sync(client=client, limit=1).items[0]
station = of("floor", "list_stations").sync(client=client, limit=1).items[0]
new = models.NewJob(kind=models.JobKindDto.DELIVER, rack=rack.id, station=station.id, priority=3)
job = of("jobs", "submit_job").sync(client=client, body=new)
assert isinstance(job, models.JobDto), job
again = of("jobs", "get_job").sync(job.id, client=client)
assert isinstance(again, models.JobDto) and again.state in models.JobStateDto, again
missing = of("jobs", "get_job").sync("j999999", client=client)
assert isinstance(missing, models.Problem) and missing.status == 404, missing
wrong = of("jobs", "submit_job").sync(client=client, body=models.NewJob(kind=models.JobKindDto.DELIVER))
assert isinstance(wrong, models.Problem), wrong
assert {e.field for e in wrong.errors} == {"rack", "station"}, wrong
print(f"pass: a Python client submitted {job.id} and read what is wrong with another one")
