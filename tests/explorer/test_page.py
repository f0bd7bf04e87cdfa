"""The first computation of a page is stopped and begun again."""

import asyncio

from tests.explorer.scenes import held, on_page, shown


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
