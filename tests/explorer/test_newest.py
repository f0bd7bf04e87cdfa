"""Only the newest request is answered."""

import asyncio
import threading

from metafem.explorer import newest
from metafem.explorer.newest import Newest
from metafem.progress import doing


def test_requests_that_wait_are_replaced_by_newer_ones():
    started, go, answers = threading.Event(), threading.Event(), []

    def work(number):
        started.set()
        go.wait(10.0)
        return number

    async def run():
        requests = Newest(work, answers.append)
        requests.put(1)
        await asyncio.to_thread(started.wait, 10.0)
        for number in range(2, 20):
            requests.put(number)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == [1, 19]


def test_a_long_computation_ends_at_its_next_step(monkeypatch):
    monkeypatch.setattr(newest, "PATIENCE", 0.0)
    started, go, answers, steps = threading.Event(), threading.Event(), [], []

    def work(number):
        started.set()
        go.wait(10.0)
        with doing("a step"):
            steps.append(number)
        return number

    async def run():
        requests = Newest(work, answers.append)
        requests.put(1)
        await asyncio.to_thread(started.wait, 10.0)
        requests.put(2)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == steps == [2]
