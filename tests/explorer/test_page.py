"""The first computation of a page is stopped and begun again, and laws and files are computed beside it."""

import asyncio

from metafem.explorer.answer import answered
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.law.further import Block
from metafem.explorer.session import State
from metafem.files import demo_text
from tests.explorer.scenes import held, on_page, shown

TEXT = demo_text("operating-points")


def test_the_first_computation_is_stopped_and_begun_again():
    async def scene(page):
        free, begun = page.queue.work, held(page)
        await page.alter()
        await asyncio.to_thread(begun.wait, 10.0)
        await page.stop()
        await shown(page)
        stopped = page.answer
        page.queue.work = free
        await page.compute()
        await shown(page)
        return stopped, page.answer, len(page.session.states)

    stopped, answer, count = on_page(scene)
    assert (stopped.stopped, stopped.design, stopped.refused) == (True, None, "")
    assert stopped.specification.target.title == answer.design.target.title
    assert (answer.current, answer.stopped, count) == (True, False, 1)


def test_the_law_under_the_block_is_computed_in_a_process_that_can_be_stopped(monkeypatch):
    monkeypatch.setattr("metafem.explorer.law.further.SLOW", "layer")
    design = answered(State(TEXT), 1).design

    async def run(end):
        states = []
        block = Block(Tasks(), lambda: states.append(block.data(design)))
        task = asyncio.create_task(block.start(design))
        await asyncio.sleep(0)
        if end:
            block.stop()
        await asyncio.gather(task, return_exceptions=True)
        return states

    first, *_, last = asyncio.run(run(end=False))
    assert (first["running"], first["shown"]) == (True, False)
    assert last == {"running": False, "step": "", "shown": True, "missing": ""}
    assert asyncio.run(run(end=True))[-1] == {"running": False, "step": "", "shown": False, "missing": ""}
